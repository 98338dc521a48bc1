#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Puts OpenCV into the cache folder: its source as Debian distributes it, and a static library of the parts that are used, compiled from it
# (setup/opencv/CMakeLists.txt). setup/wasm_libraries.sh compiles the same source for WebAssembly.
#
#   setup/opencv.sh               build it if it is missing, print its prefix
#   setup/opencv.sh --print-path  print its prefix only
#   setup/opencv.sh --source      fetch the source if it is missing, print its folder
#
# The prefix: include/opencv4/opencv2/ (headers), lib/libopencv.a.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

VERSION=4.6.0
SHA256=40a59ba7e5c18a43652de0a08733c9843a39bba619b1f3e26a5fac4a6f041423  # of the archive as Debian 12 serves it

# Of 74 MB of archive, two modules.
unpack() {  # archive, tree
  tar -xf "$1" -C "$2" --strip-components=1 --wildcards '*/LICENSE' '*/modules/core' '*/modules/imgproc' \
    --exclude='*/test' --exclude='*/perf' --exclude='*/doc' --exclude='*/misc'
}

source_path() {
  printf '%s/opencv-source-%s' "$FORMWRIGHT_CACHE_DIR" "$({
    printf '%s\n' "$VERSION" "$SHA256"
    declare -f unpack
  } | sha256sum | cut -c 1-12)"
}

# Named after all that decides what is compiled.
prefix_path() {
  printf '%s/opencv-%s' "$FORMWRIGHT_CACHE_DIR" "$({
    source_path
    grep -v '^#' "$FORMWRIGHT_ROOT/setup/opencv/CMakeLists.txt"
    c++ -dumpfullversion
    declare -f build
  } | sha256sum | cut -c 1-12)"
}

fetch() {  # folder of the source
  local work="$1.new" line address
  rm -rf "$work"
  mkdir -p "$work/tree"
  # shellcheck disable=SC2064  # the path is meant now
  trap "rm -rf '$work'" EXIT
  say "fetching the source of OpenCV $VERSION"
  private_apt "$work/apt" "deb-src $(debian_archive) $(host_codename)"
  # Debian's source package has two more archives, of which nothing is used: fetch this one only.
  line="$(apt-get -qq source --print-uris --only-source opencv | grep -F '.orig.tar.')" ||
    fail "no source of opencv is listed" "check the network and run this script again"
  address="$(cut -d "'" -f 2 <<<"$line")"
  /usr/lib/apt/apt-helper download-file "$address" "$work/opencv.tar.xz" "SHA256:$SHA256" >"$work/log" 2>&1 || {
    tail -n 5 "$work/log" >&2
    fail "Debian's archive no longer serves OpenCV $VERSION as expected, or the network failed" \
      "check the network; else set VERSION and SHA256 in setup/opencv.sh to what is served and run the tests"
  }
  unpack "$work/opencv.tar.xz" "$work/tree"
  mv "$work/tree" "$1"
  rm -rf "$work"
}

build() {  # folder of the source, prefix
  local work="$2.new"
  rm -rf "$work"
  mkdir -p "$work"
  # shellcheck disable=SC2064  # the path is meant now
  trap "rm -rf '$work'" EXIT
  say "building OpenCV $VERSION"
  {
    cmake -G Ninja -S "$FORMWRIGHT_ROOT/setup/opencv" -B "$work/build" -DOPENCV_SOURCE="$1" -DCMAKE_BUILD_TYPE=Release \
      -DCMAKE_INSTALL_PREFIX="$work/prefix" -DCMAKE_INSTALL_LIBDIR=lib &&
      nice cmake --build "$work/build" -j "${FORMWRIGHT_JOBS:-$(nproc)}" &&
      cmake --install "$work/build"
  } >"$2.log" 2>&1 || {
    tail -n 30 "$2.log" >&2
    fail "OpenCV could not be built" "read $2.log"
  }
  mv "$work/prefix" "$2"
  rm -rf "$work" "$2.log"
  say "OpenCV ready: $2 ($(du -sh "$2" | cut -f 1))"
}

main() {
  local source prefix
  source="$(source_path)"
  prefix="$(prefix_path)"
  case "${1-}" in
    --print-path)
      printf '%s\n' "$prefix"
      return
      ;;
    --source)
      prefix="$source"
      ;;
  esac
  if [ ! -d "$prefix" ]; then
    take_lock opencv
    [ -d "$source" ] || fetch "$source" >&2  # or fetched while we waited
    [ -d "$prefix" ] || build "$source" "$prefix" >&2
  fi
  printf '%s\n' "$prefix"
}

main "$@"
