#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds what runs (not its tests), makes one example end to end, serves the app.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

cd "$FORMWRIGHT_ROOT"
say "building"
setup/build.sh native-app wasm-app web

say "making an example"
build/formwright relief --sample bust --thickness-mm 5 --width-mm 120 --out build/example
printf '\nWritten to build/example:\n'
find build/example -type f -printf '  %f  %s bytes\n' | sort
echo

exec build/formwright serve
