#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# For every edit: builds natively and runs the native tests that are quick on this machine, beside the page's types, lint
# and unit tests. What it leaves out `make test` runs. The first run after a fresh build measures all tests.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
cd "$FORMWRIGHT_ROOT"

MAX_SECONDS=0.3  # a test that took longer, averaged over its runs, is left out
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

# Numbers of the tests to run, one a line: all but those that CTest has measured as slow and that passed the last time.
quick_tests() {
  local costs=build/Testing/Temporary/CTestCostData.txt
  [ -e "$costs" ] || costs=/dev/null
  ctest --preset native -N | awk -v max="$MAX_SECONDS" '
    FILENAME != "-" {
      if ($0 == "---") failures = 1
      else if (failures) failed[$0] = 1
      else { cost = $NF; name = $0; sub(/ [^ ]+ [^ ]+$/, "", name); if (cost > max) slow[name] = 1 }
      next
    }
    /^ +Test +#[0-9]+: / {
      number = $0; sub(/^ +Test +#/, "", number); sub(/:.*/, "", number)
      name = $0; sub(/^ +Test +#[0-9]+: /, "", name)
      if (!(name in slow) || name in failed) print number
    }' "$costs" -
}

check_core() {
  setup/format.sh --check
  setup/build.sh native
  quick_tests >"$work/numbers"
  say "$(wc -l <"$work/numbers") of $(ctest --preset native -N | sed -n 's/^Total Tests: //p') native tests"
  # CTest reads numbers behind "start,end,stride", which choose nothing here.
  ctest --preset native --parallel "${FORMWRIGHT_JOBS:-$(nproc)}" -I "0,0,0,$(paste -s -d , "$work/numbers")"
}

check_page() {
  setup/build.sh npm-packages
  # As `npm run types` and `npm run lint`, but looking only at what has changed: 3 instead of 40 s of processor time.
  local kept=node_modules/.cache/formwright project
  mkdir -p "$kept"
  for project in web/tsconfig.json web/tsconfig.node.json e2e/tsconfig.json; do
    npx tsc --noEmit -p "$project" --incremental --tsBuildInfoFile "$FORMWRIGHT_ROOT/$kept/${project//\//_}.tsbuildinfo"
  done
  npx eslint --cache --cache-strategy content --cache-location "$kept/eslint" .
  npx prettier --log-level warn --check --cache --cache-location "$kept/prettier" .
  npx knip
  npm run -s test
}

setup/native.sh --test
# `set -e` would be off within an `if` or `||`, so both run in shells of their own.
(check_page) >"$work/page.log" 2>&1 &
page=$!
(check_core) >"$work/core.log" 2>&1 &
core=$!
failed=()
wait "$core" || failed+=(core)
tail -n 12 "$work/core.log"
wait "$page" || failed+=(page)
tail -n 8 "$work/page.log"
for part in "${failed[@]}"; do
  printf '\n=== %s failed\n' "$part"
  cat "$work/$part.log"
done
say "done"
[ ${#failed[@]} -eq 0 ]
