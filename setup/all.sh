#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# All of the set-up; with --test, also what only testing needs.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

cd "$FORMWRIGHT_ROOT"
setup/native.sh "$@"
setup/wasm_toolchain.sh >/dev/null
setup/wasm_libraries.sh >/dev/null
setup/catch2.sh >/dev/null
setup/opencv.sh >/dev/null
if [ "${1-}" = --test ]; then
  setup/python_packages.sh >/dev/null
  setup/test_peers.sh >/dev/null
fi
say "set-up complete"
