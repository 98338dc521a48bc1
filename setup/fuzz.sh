#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the fuzz targets (fuzz_*) with libFuzzer and runs each for a while.
# New inputs stay in the cache folder and are where the next run begins.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

cd "$FORMWRIGHT_ROOT"
setup/native.sh --test
setup/wasm_toolchain.sh >/dev/null
cmake --preset fuzz
nice cmake --build --preset fuzz --parallel "${FORMWRIGHT_JOBS:-$(nproc)}"
mapfile -t programs < <(find build-fuzz -type f -executable -name 'fuzz_*' | sort)
[ ${#programs[@]} -gt 0 ] || fail "no fuzz target was built" "name its CMake target fuzz_<what>"
for program in "${programs[@]}"; do
  name="${program##*/}"
  corpus="$FORMWRIGHT_CACHE_DIR/fuzz/$name"
  mkdir -p "$corpus"
  say "fuzzing $name for ${FUZZ_SECONDS:-60} s"
  "$program" -max_total_time="${FUZZ_SECONDS:-60}" -rss_limit_mb=2048 -artifact_prefix=build-fuzz/ "$corpus"
done
