#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Programs of others that the machine tests talk to and that Debian does not have (setup/test_peers.txt), in a
# virtual environment in the cache. Prints its folder.
#
#   setup/test_peers.sh               install if missing, print the folder
#   setup/test_peers.sh --print-path  print the folder only
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

packages="$FORMWRIGHT_ROOT/setup/test_peers.txt"
peers="$FORMWRIGHT_CACHE_DIR/peers-$(sha256sum "$packages" | cut -c1-12)"
if [ "${1-}" != --print-path ] && [ ! -e "$peers/complete" ]; then
  take_lock peers
  if [ ! -e "$peers/complete" ]; then
    say "installing the programs that machine tests talk to"
    rm -rf "$peers"
    /usr/bin/python3 -m venv "$peers" >&2
    "$peers/bin/pip" install --quiet --disable-pip-version-check --requirement "$packages" >&2 ||
      fail "the Python packages for testing could not be installed" "check the network"
    touch "$peers/complete"
  fi
fi
printf '%s\n' "$peers"
