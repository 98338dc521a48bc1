#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds what is named: native, asan, wasm (CMake presets), native-app, wasm-app (the same without their tests),
# package (the program for any x86-64 processor), web (the page). `npm-packages` installs what the page and the stories need.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

build_preset() {  # preset of the configuration, preset of the build
  # Configuring again costs a second and notices a new toolchain. What the environment does not say the preset does.
  cmake --preset "$1" ${FORMWRIGHT_CRAFT_TESTS:+-DFORMWRIGHT_CRAFT_TESTS="$FORMWRIGHT_CRAFT_TESTS"} \
    ${FORMWRIGHT_LONG_TESTS:+-DFORMWRIGHT_LONG_TESTS="$FORMWRIGHT_LONG_TESTS"} >&2
  nice cmake --build --preset "$2" --parallel "${FORMWRIGHT_JOBS:-$(nproc)}" >&2
}

# `npm ci` deletes node_modules: do it only when the lock file has changed.
install_packages() {
  local stamp=node_modules/.formwright-lock
  if ! cmp -s package-lock.json "$stamp"; then
    PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD=1 npm ci --no-audit --no-fund >&2
    cp package-lock.json "$stamp"
  fi
}

cd "$FORMWRIGHT_ROOT"
for part in "$@"; do
  case "$part" in
    native | asan | wasm | package) build_preset "$part" "$part" ;;
    native-app | wasm-app) build_preset "${part%-app}" "$part" ;;
    npm-packages) install_packages ;;
    web)
      install_packages
      npm run build >&2
      ;;
    *) fail "there is nothing to build called '$part'" "choose from native, asan, wasm, native-app, wasm-app, package, web" ;;
  esac
done
