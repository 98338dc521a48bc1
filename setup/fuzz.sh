#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds the fuzz targets (tests/fuzz) with libFuzzer and runs each for FUZZ_SECONDS (60) of processor time, at the lowest priority.
#   FUZZ_SECONDS=600 setup/fuzz.sh [obj stl ply glb ...]   all targets, or these
#   setup/fuzz.sh --table                                  what all runs so far came to, by target
# New inputs stay in the cache folder, where the next run begins; so do the logs of which --table adds up the figures.
# FUZZ_JOBS targets run beside each other (1). Nothing runs for more than FUZZ_MAX_WAIT (30) times as long by the clock.
# What it finds stays in build-fuzz/findings; each target goes on after a finding until its time is up or it has found ten.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

cd "$FORMWRIGHT_ROOT"
corpus="$FORMWRIGHT_CACHE_DIR/fuzz" findings=build-fuzz/findings
logs="$corpus/logs"

# The values of lines "stat::NAME: value" in a log: their sum, or the largest.
statistic() {  # log, name, sum or largest
  awk -v name="stat::$2:" -v how="$3" '$1 == name { sum += $2; if ($2 > largest) largest = $2 } END { print (how == "sum" ? sum : largest) + 0 }' "$1"
}

table() {
  local log name
  printf '%s\n' '| target | runs | processor time, s | edges | largest memory, MB | slowest, s | found |' '|---|---:|---:|---:|---:|---:|---:|'
  for log in "$logs"/*.log; do
    [ -f "$log" ] || continue
    name="$(basename "$log" .log)"
    # shellcheck disable=SC2016  # the backquotes are Markdown
    printf '| `%s` | %s | %s | %s | %s | %s | %s |\n' "$name" "$(statistic "$log" number_of_executed_units sum)" \
      "$(statistic "$log" seconds sum)" "$(grep -oE ' cov: [0-9]+' "$log" | awk '$2 > n { n = $2 } END { print n + 0 }')" \
      "$(statistic "$log" largest_mb largest)" "$(statistic "$log" slowest_s largest)" \
      "$(grep -c 'Test unit written' "$log" || true)"
  done
}
if [ "${1-}" = --table ]; then
  table
  exit
fi

setup/native.sh --test
setup/wasm_toolchain.sh >/dev/null
setup/catch2.sh >/dev/null
cmake --preset fuzz >&2
nice cmake --build --preset fuzz --parallel "${FORMWRIGHT_JOBS:-$(nproc)}" >&2

mkdir -p "$corpus" "$findings" "$logs"
build-fuzz/tests/fuzz/make_fuzz_seeds build-fuzz/seeds
if [ $# -gt 0 ]; then
  targets=("$@")
else
  mapfile -t targets < <(find build-fuzz/tests/fuzz -maxdepth 1 -type f -name 'fuzz_*' -executable -printf '%f\n' | sed 's/^fuzz_//' | sort)
fi
[ ${#targets[@]} -gt 0 ] || fail "no fuzz target was built" "name its CMake target fuzz_<what>"

# Sets `used` to the processor seconds of this shell's children that have ended: "1m2.345s 0m1.234s" in the second line. A pipe
# would be another shell.
measure_used() {  # a file to write into
  times >"$1"
  used=$(awk -F'[ms ]+' 'NR == 2 { printf "%d", $1 * 60 + $2 + $3 * 60 + $4 }' "$1")
  rm "$1"
}

# Runs one target until its time is up; "found" in its log counts what it was restarted for.
fuzz_one() {  # name
  local name="$1" begin=$SECONDS seconds="${FUZZ_SECONDS:-60}" end found=0 used=0 code
  local dictionary="tests/fuzz/dictionaries/$name.dict" log="$logs/$name.log"
  end=$((begin + seconds * ${FUZZ_MAX_WAIT:-30}))
  mkdir -p "$corpus/$name" "build-fuzz/seeds/$name"
  # Memory and processor time of one input are counted by the target itself (fuzz_entry.cpp); these limits end what runs away,
  # and libFuzzer's own report of slow inputs goes by the clock of a busy machine.
  local options=(-max_len=1048576 -timeout=300 -report_slow_units=3600 -rss_limit_mb=2048 -malloc_limit_mb=1024 -print_final_stats=1)
  [ ! -f "$dictionary" ] || options+=(-dict="$dictionary")
  local folders=("$corpus/$name" "build-fuzz/seeds/$name")
  [ ! -d "tests/fuzz/found/$name" ] || folders+=("tests/fuzz/found/$name")
  while [ $SECONDS -lt $end ] && [ $found -lt 10 ] && [ $used -lt "$seconds" ]; do
    code=0
    FORMWRIGHT_FUZZ_SECONDS=$((seconds - used)) nice -n "${FUZZ_NICE:-19}" "build-fuzz/tests/fuzz/fuzz_$name" \
      "${options[@]}" -max_total_time=$((end - SECONDS)) -artifact_prefix="$findings/$name-" "${folders[@]}" >>"$log" 2>&1 || code=$?
    measure_used "$log.times"
    case $code in 0 | 72) break ;; esac  # 72: its processor time was over
    found=$((found + 1))
    grep -E '^SUMMARY|Test unit written' "$log" | tail -n 2 >&2
  done
  printf 'stat::seconds: %d\n' "$used" >>"$log"
  printf '%s: %d s of processor time in %d s, %d inputs kept, %d findings\n' "$name" "$used" $((SECONDS - begin)) "$(find "$corpus/$name" -type f | wc -l)" "$found"
  [ $found -eq 0 ]
}

status=0
running=()
for name in "${targets[@]}"; do
  fuzz_one "$name" &
  running+=($!)
  if [ ${#running[@]} -ge "${FUZZ_JOBS:-1}" ]; then
    wait "${running[0]}" || status=1
    running=("${running[@]:1}")
  fi
done
for job in "${running[@]}"; do wait "$job" || status=1; done
table
exit $status
