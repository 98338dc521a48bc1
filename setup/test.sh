#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Sets up, builds and runs what a change must pass, stopping at the first stage that fails. Tests that failed and passed
# when asked again are named at the end: each is a defect. The last line is "N passed, N failed", summed over all runners.
# What passed at the first asking is kept in build*/ and counted without running it again while its programs, scripts and
# data are the same (setup/passed_before.py); FORMWRIGHT_PASSED_BEFORE=forget runs everything.
#   setup/test.sh [--all]   with --all the crafts' own tests run with sanitizers and in WebAssembly, too, and the reliability
#                           tests in their long forms
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
. "$(dirname "${BASH_SOURCE[0]}")/test_counts.sh"
cd "$FORMWRIGHT_ROOT"
case "${1-}" in
  '') ;;
  --all) export FORMWRIGHT_CRAFT_TESTS=ON FORMWRIGHT_LONG_TESTS=ON ;;
  *) fail "test.sh does not know '$1'" "use --all or nothing" ;;
esac

PASSED=0
FAILED=0
COMPLETE=no  # until the last stage has passed; an interruption is a failure
FLAKY=()
LOG="$(mktemp)"
STORIES_LOG="$(mktemp)"
BESIDE=''         # process group of what is built while other stages run
BESIDE_LOG="$(mktemp)"
BESIDE_START=0
BESIDE_COMMAND=()
BESIDE_STATUS=0

finish() {
  [ -z "$BESIDE" ] || kill -- "-$BESIDE" 2>/dev/null || true
  rm -f "$LOG" "$STORIES_LOG" "$BESIDE_LOG"
  if [ "$COMPLETE" = no ] && [ "$FAILED" -eq 0 ]; then FAILED=1; fi
  if [ "$PASSED" -eq 0 ] && [ "$FAILED" -eq 0 ]; then FAILED=1; fi
  if [ ${#FLAKY[@]} -gt 0 ]; then
    printf '%d passed only when asked again (each is a defect to fix):\n' "${#FLAKY[@]}"
    printf '  %s\n' "${FLAKY[@]}"
  fi
  printf '%d passed, %d failed\n' "$PASSED" "$FAILED"
  [ "$FAILED" -eq 0 ] || exit 1
}
trap finish EXIT

# Runs a command and shows it; `runner` tells how to count its tests.
stage() {  # name, runner or -, command...
  local name="$1" runner="$2" start=$SECONDS status=0 passed=0 failed=0 counts=''
  shift 2
  printf '\n=== %s\n' "$name"
  # Colour codes would hide the numbers. CI: vitest and playwright ask once more for what has failed.
  NO_COLOR=1 CI=1 "$@" 2>&1 | tee "$LOG" || status=$?
  if [ "$runner" != - ]; then
    read -r passed failed < <("count_$runner" "$LOG")
    PASSED=$((PASSED + passed))
    FAILED=$((FAILED + failed))
    counts=": $passed passed, $failed failed"
    mapfile -t -O "${#FLAKY[@]}" FLAKY < <("flaky_$runner" "$LOG" | sed "s/^/$name: /")
    if [ "$passed" -eq 0 ] && [ "$status" -eq 0 ]; then
      status=1
      counts=": no test ran"
    fi
  fi
  printf '=== %s%s (%d s)\n' "$name" "$counts" "$((SECONDS - start))"
  if [ "$status" -ne 0 ] || [ "$failed" -gt 0 ]; then
    printf '=== stopped: %s failed\n' "$name"
    exit 1
  fi
}

# Tests wait for timers, stories for pictures: a build of the lowest priority takes what they leave of the processors. The
# kernel shares time among sessions before it looks at niceness (sched(7), autogroup): so the build has a session of its own.
begin_beside() {  # command...
  BESIDE_COMMAND=("$@")
  BESIDE_START=$SECONDS
  # Where a session may not choose its share, tests would wait for the compiler: the build comes after them.
  if [ -e /proc/self/autogroup ] && ! setsid sh -c 'echo 19 >/proc/self/autogroup' 2>/dev/null; then return 0; fi
  # The kernel takes one such choice in a tenth of a second.
  # shellcheck disable=SC2016  # the inner shell expands it
  setsid nice -n 19 sh -c 'sleep 0.2; echo 19 >/proc/self/autogroup; exec "$@"' sh "$@" >"$BESIDE_LOG" 2>&1 </dev/null &
  BESIDE=$!  # its process group, too
}
await_beside() {
  BESIDE_STATUS=0
  if [ -n "$BESIDE" ]; then
    wait "$BESIDE" || BESIDE_STATUS=$?
  else
    "${BESIDE_COMMAND[@]}" >"$BESIDE_LOG" 2>&1 || BESIDE_STATUS=$?
  fi
  BESIDE=''
}
show_beside() {
  cat "$BESIDE_LOG"
  printf 'begun %d s ago, beside other stages\n' "$((SECONDS - BESIDE_START))"
  return "$BESIDE_STATUS"
}

forgets() { [ "${FORMWRIGHT_PASSED_BEFORE-}" = forget ]; }

# What the stories run is the page, both ways to solve, and themselves.
run_stories() {  # wasm or native
  local record="build/stories_$1" hash known='' count='' status=0
  hash="$(setup/passed_before.py hash e2e web/dist package-lock.json build/formwright)"
  if ! forgets && [ -e "$record" ]; then read -r known count <"$record"; fi
  if [ "$known" = "$hash" ]; then
    echo "$count tests passed before with the same programs and data"
    return
  fi
  rm -f "$record"
  FORMWRIGHT_BACKEND="$1" npm run e2e 2>&1 | tee "$STORIES_LOG" || status=$?
  read -r count _ < <(count_playwright "$STORIES_LOG")
  if [ "$status" -eq 0 ] && [ -z "$(flaky_playwright "$STORIES_LOG")" ]; then echo "$hash $count" >"$record"; fi
  return "$status"
}

# What failed, again and last: where only the end of a log is seen, it is what is needed.
show_failed() {  # folder of a build
  awk '/^[0-9]+\/[0-9]+ Testing: / { name = $3; count = 0 }
       { lines[count++] = $0 }
       /^Test (Failed|timeout)/ { print "--- " name; for (i = count > 30 ? count - 30 : 0; i < count; ++i) print lines[i] }' "$1/Testing/Temporary/LastTest.log"
}
# Tests run side by side, and some drive real programs that have limits of time of their own. What fails is shown and asked once more, alone; what
# passes then is named at the end.
run_ctest() {  # preset, folder of its build
  local numbers status=0 all
  if forgets; then rm -f "$2/passed_before.json"; fi
  numbers="$(setup/passed_before.py tests "$2" --preset "$1")"
  all="$(ctest --preset "$1" -N | sed -n 's/^Total Tests: //p')"
  echo "$((all - $(wc -w <<<"$numbers"))) tests passed before with the same programs and data"
  [ -n "$numbers" ] || return 0
  # CTest reads numbers behind "start,end,stride", which choose nothing here.
  ctest --preset "$1" --parallel "${FORMWRIGHT_JOBS:-$(nproc)}" -I "0,0,0,$(paste -s -d , <<<"$numbers")" \
    --output-junit junit.xml || status=$?
  setup/passed_before.py keep "$2" "$2/junit.xml"
  [ "$status" -ne 0 ] || return 0
  show_failed "$2"
  printf '\n=== once more, alone\n'
  ctest --preset "$1" --rerun-failed && return
  show_failed "$2"
  return 1
}

main() {
  stage 'set-up' - setup/all.sh --test
  stage 'page: packages' - setup/build.sh npm-packages
  begin_beside setup/build.sh native
  stage 'C++ formatting' - setup/format.sh --check
  stage 'page: types' - npm run types
  stage 'page: lint' - npm run lint
  await_beside
  stage 'native build' - show_beside
  begin_beside setup/build.sh wasm
  stage 'native tests' ctest run_ctest native build
  await_beside
  stage 'WebAssembly build' - show_beside
  stage 'WebAssembly tests' ctest run_ctest wasm build-wasm
  stage 'page: unit tests' vitest npm test
  stage 'page: build' - setup/build.sh web
  begin_beside setup/build.sh asan
  stage 'browser tests, solving in the page' playwright run_stories wasm
  stage 'browser tests, with the native worker' playwright run_stories native
  await_beside
  stage 'sanitizer build' - show_beside
  stage 'sanitizer tests' ctest run_ctest asan build-asan
  COMPLETE=yes
  echo
}

main "$@"
