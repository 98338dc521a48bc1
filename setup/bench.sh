#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds natively and runs every benchmark program (build/**/bench_*).
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

cd "$FORMWRIGHT_ROOT"
setup/build.sh native
mapfile -t programs < <(find build -type f -executable -name 'bench_*' | sort)
[ ${#programs[@]} -gt 0 ] || fail "no benchmark was built" "name its CMake target bench_<what>"
for program in "${programs[@]}"; do
  printf '\n=== %s\n' "${program##*/}"
  "$program" "$@"
done
