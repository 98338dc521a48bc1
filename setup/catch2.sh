#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Puts the source of Catch2 3 into the cache folder: Debian 13's, for Debian 12 has version 2 only. Every build compiles it with its own flags
# (cmake/catch2.cmake).
#
#   setup/catch2.sh               fetch it if it is missing, print its path
#   setup/catch2.sh --print-path  print its path only
#
# The tree: catch2/ (headers, with Catch2's default settings), catch_amalgamated.{hpp,cpp} (the library in one file), Catch.cmake (test discovery).
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

SUITE=trixie
VERSION=3.7.1  # the program's own version, without Debian's revision
SHA256=c991b247a1a0d7bb9c39aa35faf0fe9e19764213f28ffba3109388e62ee0269c

# What CMake would make of the template of the settings where none is changed.
write_settings() {  # folder of the headers
  sed -e 's|^#cmakedefine \([A-Z_0-9]*\).*|/* #undef \1 */|' -e 's|@CATCH_CONFIG_DEFAULT_REPORTER@|console|' -e 's|@CATCH_CONFIG_CONSOLE_WIDTH@|80|' \
    "$1/catch_user_config.hpp.in" >"$1/catch_user_config.hpp"
  ! grep -n '@' "$1/catch_user_config.hpp" >&2 ||
    fail "catch_user_config.hpp.in has a setting that setup/catch2.sh does not know" "give it Catch2's default in write_settings"
}

unpack() {  # archive, tree
  tar -xf "$1" -C "$2" --strip-components=1 --wildcards '*/src/catch2' '*/extras/*' '*/LICENSE.txt'
  mv "$2/src/catch2" "$2/catch2"
  mv "$2"/extras/catch_amalgamated.* "$2"/extras/Catch.cmake "$2"/extras/CatchAddTests.cmake "$2/"
  rm -rf "$2/src" "$2/extras"
  find "$2/catch2" -name '*.cpp' ! -name catch_main.cpp -delete
  write_settings "$2/catch2"
}

# Names the tree after all that decides its content.
tree_path() {
  printf '%s/catch2-%s' "$FORMWRIGHT_CACHE_DIR" "$({
    printf '%s\n' "$VERSION" "$SHA256"
    declare -f unpack write_settings
  } | sha256sum | cut -c 1-12)"
}

fetch() {  # tree
  local work="$1.new"
  rm -rf "$work"
  mkdir -p "$work/tree" "$work/source"
  # shellcheck disable=SC2064  # the path is meant now
  trap "rm -rf '$work'" EXIT
  say "fetching the source of Catch2 $VERSION"
  private_apt "$work/apt" "deb-src $(debian_archive) $SUITE"
  local archive="$work/source/catch2_$VERSION.orig.tar.gz"
  (cd "$work/source" && apt-get -qq source --download-only --only-source catch2) ||
    fail "the source of catch2 could not be fetched from $SUITE" "check the network and run this script again"
  printf '%s  %s\n' "$SHA256" "$archive" | sha256sum --check --quiet >&2 ||
    fail "$SUITE no longer serves Catch2 $VERSION as expected" "set VERSION and SHA256 in setup/catch2.sh to what it serves and run the tests"
  unpack "$archive" "$work/tree"
  mv "$work/tree" "$1"
}

main() {
  local tree
  tree="$(tree_path)"
  if [ "${1-}" != --print-path ] && [ ! -d "$tree" ]; then
    take_lock catch2
    [ -d "$tree" ] || fetch "$tree" >&2  # or made while we waited
  fi
  printf '%s\n' "$tree"
}

main "$@"
