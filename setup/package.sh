#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes a Debian package for any x86-64 processor and prints its path.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

cd "$FORMWRIGHT_ROOT"
say "building"
setup/build.sh wasm-app web package
say "packing"
(cd build-package && cpack --verbose >cpack.log 2>&1) || {
  tail -n 20 build-package/cpack.log >&2
  fail "the package could not be made" "read build-package/cpack.log"
}
ls build-package/formwright_*.deb
