# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=bash
# What the logs of the test runners say. Source it; tests/architecture/test_counts_test.py checks it on logs.
# count_RUNNER prints "passed failed" (skipped tests are neither); flaky_RUNNER prints the names of tests that failed and
# passed when asked again, one a line.

# A stage that need not run again says so.
count_before() { sed -nE 's/^([0-9]+) tests passed before .*/\1/p' "$1" | sum; }

sum() { awk '{ total += $1 } END { print total + 0 }'; }

# How many there are the first run says, what has failed the last one.
count_ctest() {  # log
  local all failed skipped
  read -r _ all < <(sed -nE 's/^[0-9]+% tests passed, ([0-9]+) tests? failed out of ([0-9]+)$/\1 \2/p' "$1" | head -n 1) || true
  read -r failed _ < <(sed -nE 's/^[0-9]+% tests passed, ([0-9]+) tests? failed out of ([0-9]+)$/\1 \2/p' "$1" | tail -n 1) || true
  skipped="$(grep -cE '^ *[0-9]+/[0-9]+ Test .*\*\*\*(Skipped|Not Run)' "$1" || true)"
  echo "$((${all:-0} - ${failed:-0} - skipped + $(count_before "$1"))) ${failed:-0}"
}

# Names in the first run's list of failures that are not in the last one's; nothing when it was run once.
flaky_ctest() {  # log
  awk '/^[0-9]+% tests passed,/ { ++runs }
       /^\t *[0-9]+ - .* \((Failed|Timeout|SEGFAULT|ILLEGAL|Child aborted|Subprocess aborted|Not Run|.*Exception.*)\)/ {
         name = $0; sub(/^\t *[0-9]+ - /, "", name); sub(/ \([^()]*\).*$/, "", name)
         if (runs == 1) first[++count] = name; else again[name] = 1
       }
       END { if (runs > 1) for (i = 1; i <= count; ++i) if (!(first[i] in again)) print first[i] }' "$1"
}

# What neither passed nor was left out has failed: a worker that crashed leaves tests that never ran, "389 passed (394)".
count_vitest() {  # log
  awk '/^ +Tests +/ {
         passed = left_out = all = 0
         for (i = 2; i <= NF; ++i) {
           if ($i == "passed") passed = $(i - 1)
           if ($i == "skipped" || $i == "todo") left_out += $(i - 1)
           if ($i ~ /^\([0-9]+\)$/) all = substr($i, 2) + 0
         }
       }
       END { print passed + 0, all - passed - left_out }' "$1"
}
flaky_vitest() { sed -n 's/^passed when asked again: //p' "$1"; }  # web/scripts/flaky_reporter.ts

count_playwright() {  # log
  echo "$(($(grep -oE '^ +[0-9]+ (passed|flaky)' "$1" | sum) + $(count_before "$1"))) $(grep -oE '^ +[0-9]+ (failed|did not run|interrupted)' "$1" | sum)"
}
flaky_playwright() {  # log; names are indented below "N flaky"
  awk '/^ +[0-9]+ (passed|failed|skipped|did not run|interrupted)/ { listed = 0 }
       listed && /^    / { name = $0; sub(/^ +/, "", name); sub(/[ ─]+$/, "", name); print name }
       /^ +[0-9]+ flaky/ { listed = 1 }' "$1"
}
