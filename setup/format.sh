#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Formats the C++ sources in place; with --check, says which are not as .clang-format wants them and changes nothing.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

cd "$FORMWRIGHT_ROOT"
case "${1-}" in
  '') arguments=(-i) ;;
  --check) arguments=(--dry-run --Werror) ;;
  *) fail "format.sh does not know '$1'" "use --check or nothing" ;;
esac
git ls-files -z '*.cpp' '*.h' | xargs -0 -n 40 -P "${FORMWRIGHT_JOBS:-$(nproc)}" clang-format "${arguments[@]}" ||
  fail "C++ sources are not formatted" "run 'make format'"
