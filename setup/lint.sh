#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Reads everything, changes nothing: formatting, clang-tidy, shell, the page.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

cd "$FORMWRIGHT_ROOT"
setup/native.sh --test
say "formatting"
setup/format.sh --check
say "names"
python3 tests/architecture/check_words.py
say "shell scripts"
shellcheck -x --source-path=SCRIPTDIR setup/*.sh .ci/run
say "clang-tidy"
# With every file by itself, not in groups.
cmake --preset native -B build-lint -D FORMWRIGHT_UNITY=OFF >&2
git ls-files -z 'core/**.cpp' 'native_worker/**.cpp' |
  xargs -0 -n 4 -P "${FORMWRIGHT_JOBS:-$(nproc)}" nice clang-tidy-16 --quiet -p build-lint --extra-arg=-Wno-unknown-warning-option --warnings-as-errors='*'
say "the page and its stories"
setup/build.sh npm-packages
npm run types
npm run lint
