#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds natively and for WebAssembly and runs every benchmark program (build/**/bench_*), then the relief's and
# thermoforming's, which compare both. DATA=FOLDER with bunny.obj and koala.obj adds these. Every benchmark prints JSON.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

cd "$FORMWRIGHT_ROOT"
setup/build.sh native wasm
cmake --build --preset native --target benchmarks >&2
mapfile -t programs < <(find build -type f -executable -name 'bench_*' | sort)
[ ${#programs[@]} -gt 0 ] || fail "no benchmark was built" "name its CMake target bench_<what>"
for program in "${programs[@]}"; do
  printf '\n=== %s\n' "${program##*/}"
  "$program" "$@"
done
printf '\n=== bench_relief\n'
node tests/bench/relief/bench_relief.mjs build/formwright build-wasm/wasm/formwright.mjs ${DATA:+--data "$DATA"}
printf '\n=== bench_thermoform\n'
node tests/bench/thermoform/bench_thermoform.mjs build/formwright build-wasm/wasm/formwright.mjs --large
