#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Installs the PyPI packages that tests judge our files with into a folder of the cache, for Debian's own Python, and prints the folder.
#
#   setup/python_packages.sh               install if missing, print the folder
#   setup/python_packages.sh --print-path  print the folder only
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

LIST="$FORMWRIGHT_ROOT/setup/python_packages_test.txt"
FOLDER="$FORMWRIGHT_CACHE_DIR/python-$(sha256sum "$LIST" | cut -c 1-12)"

if [ "${1-}" != --print-path ] && [ ! -d "$FOLDER" ]; then
  take_lock python
  if [ ! -d "$FOLDER" ]; then
    say "fetching Python packages for the tests"
    rm -rf "$FOLDER.new"
    /usr/bin/python3 -m pip install --quiet --disable-pip-version-check --root-user-action=ignore --no-deps --target "$FOLDER.new" -r "$LIST" >&2 ||
      fail "pip could not fetch the packages" "check the network and run this script again"
    mv "$FOLDER.new" "$FOLDER"
  fi
fi
printf '%s\n' "$FOLDER"
