#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the fuzz targets (tests/fuzz) with libFuzzer and runs each for FUZZ_SECONDS (60), at low priority.
#   FUZZ_SECONDS=600 setup/fuzz.sh [obj stl ply glb three_mf three_mf_model mtl png16]
# New inputs stay in the cache folder, where the next run begins. What it finds stays in build-fuzz/findings; each
# target goes on after a finding until its time is up or it has found ten.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

cd "$FORMWRIGHT_ROOT"
setup/native.sh --test
setup/wasm_toolchain.sh >/dev/null
cmake --preset fuzz >&2
nice cmake --build --preset fuzz --parallel "${FORMWRIGHT_JOBS:-$(nproc)}" >&2

corpus="$FORMWRIGHT_CACHE_DIR/fuzz" findings=build-fuzz/findings logs=build-fuzz/logs
mkdir -p "$corpus" "$findings" "$logs"
build-fuzz/tests/fuzz/make_fuzz_seeds build-fuzz/seeds
if [ $# -gt 0 ]; then
  targets=("$@")
else
  mapfile -t targets < <(find build-fuzz/tests/fuzz -maxdepth 1 -type f -name 'fuzz_*' -executable -printf '%f\n' | sed 's/^fuzz_//' | sort)
fi
[ ${#targets[@]} -gt 0 ] || fail "no fuzz target was built" "name its CMake target fuzz_<what>"

# The value of a line "stat::NAME: value", summed over the runs in a log.
statistic() { awk -v name="stat::$2:" '$1 == name { sum += $2 } END { print sum + 0 }' "$1"; }

status=0
for name in "${targets[@]}"; do
  mkdir -p "$corpus/$name"
  dictionary="tests/fuzz/dictionaries/$name.dict" log="$logs/$name.log" begin=$SECONDS found=0
  end=$((begin + ${FUZZ_SECONDS:-60}))
  options=(-max_len=65536 -timeout=20 -rss_limit_mb=2048 -malloc_limit_mb=1024 -print_final_stats=1)
  [ ! -f "$dictionary" ] || options+=(-dict="$dictionary")
  : >"$log"
  while [ $SECONDS -lt $end ] && [ $found -lt 10 ]; do
    if nice -n 19 "build-fuzz/tests/fuzz/fuzz_$name" "${options[@]}" -max_total_time=$((end - SECONDS)) \
      -artifact_prefix="$findings/$name-" "$corpus/$name" "build-fuzz/seeds/$name" >>"$log" 2>&1; then
      break
    fi
    found=$((found + 1)) status=1
    grep -E '^SUMMARY|Test unit written' "$log" | tail -n 2 >&2
  done
  printf '%s: %d s, %d executions, %d inputs kept, %d findings\n' "$name" $((SECONDS - begin)) \
    "$(statistic "$log" number_of_executed_units)" "$(find "$corpus/$name" -type f | wc -l)" "$found"
done
exit $status
