#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Puts a WebAssembly toolchain beside the system, never into it: Debian 13's
# Emscripten 3.1.69 (clang 19) with CGAL 6.0.1 and Boost 1.83 headers, unpacked
# into the cache folder and run through the tree's own dynamic linker. If the
# machine has a suitable emcc, that one is used and only the headers are fetched.
#
#   setup/wasm_toolchain.sh               make it, print its path
#   setup/wasm_toolchain.sh --print-path  print its path only
#
# The tree: bin/emcc, bin/em++, ...; emscripten.cmake (CMake toolchain file);
# include/{CGAL,boost} (nothing else, so native compilers may use it too).
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

SUITE=trixie
MINIMUM_EMCC=3.1.60
LLVM=19
COMPILER_PACKAGES=(
  emscripten binaryen node-acorn
  "clang-$LLVM" "lld-$LLVM" "llvm-$LLVM" "llvm-$LLVM-linker-tools" "libclang-common-$LLVM-dev"
  # what the programs above load; the tree has its own libc
  "libclang-cpp$LLVM" "libllvm$LLVM" libc6 libstdc++6 libgcc-s1 zlib1g libzstd1 libxml2
  libicu76 liblzma5 libedit2 libtinfo6 libbsd0 libmd0 libz3-4 libffi8
)
HEADER_PACKAGES=(libcgal-dev libboost1.83-dev)
# Of Emscripten's 1.6 GB of prebuilt system libraries, those that we never link.
UNUSED_FILES=(
  './usr/share/emscripten/test' './usr/share/emscripten/docs' './usr/share/emscripten/media'
  './usr/share/emscripten/cache/sysroot/lib/*/pic' './usr/share/emscripten/cache/sysroot/lib/*/lto-pic'
  './usr/share/emscripten/cache/sysroot/lib/*-ww*' './usr/share/emscripten/cache/sysroot/lib/*/libGL-*emu*'
  './usr/share/emscripten/cache/sysroot/lib/*/libGL-*webgl2*' './usr/share/emscripten/cache/sysroot/lib/*/libGL-*es3*'
  './usr/share/man' './usr/share/locale' './usr/share/doc/*/examples' './usr/share/bug'
)

# Prints an emcc of this machine that is new enough, if there is one.
suitable_emcc() {
  local found version
  found="$(command -v emcc || true)"
  case "$found" in '' | "$FORMWRIGHT_CACHE_DIR"/*) return 0 ;; esac
  version="$("$found" -dumpversion 2>/dev/null | grep -oE '^[0-9]+\.[0-9]+\.[0-9]+' || true)"
  [ -n "$version" ] || return 0
  if [ "$(printf '%s\n' "$MINIMUM_EMCC" "$version" | sort -V | head -n 1)" = "$MINIMUM_EMCC" ]; then
    printf '%s %s' "$found" "$version"
  fi
}

# Python of the distribution before any shim on PATH (a shim costs 50 ms per call).
find_python() {
  local python
  for python in /usr/bin/python3 python3; do
    if "$python" -c 'import sys; sys.exit(sys.version_info < (3, 8))' 2>/dev/null; then
      command -v "$python"
      return
    fi
  done
  fail "no python3 of at least 3.8 was found" "run setup/native.sh first"
}

unpack() {  # folder with packages, tree
  local debs="$1" tree="$2" exclude=() pattern deb
  for pattern in "${UNUSED_FILES[@]}"; do exclude+=("--exclude=$pattern"); done
  # shellcheck disable=SC2016  # for the inner shell
  local unpack_one='dpkg-deb --fsys-tarfile "$0" | tar -x --no-same-owner -C "$@"'
  # One package is as large as all others together: unpack it beside them.
  local pids=()
  for deb in "$debs"/emscripten_*.deb; do
    [ -e "$deb" ] || continue
    bash -o pipefail -c "$unpack_one" "$deb" "$tree" "${exclude[@]}" &
    pids+=($!)
  done
  for deb in "$debs"/*.deb; do
    case "${deb##*/}" in emscripten_*) continue ;; esac
    bash -o pipefail -c "$unpack_one" "$deb" "$tree" "${exclude[@]}" ||
      fail "${deb##*/} could not be unpacked" "free some disk space in $FORMWRIGHT_CACHE_DIR"
  done
  local pid
  for pid in "${pids[@]}"; do
    wait "$pid" || fail "Emscripten could not be unpacked" "free some disk space in $FORMWRIGHT_CACHE_DIR"
  done
}

# A program of the tree, runnable on any host: the tree's linker loads it with
# the tree's libraries, and nothing leaks in from the host or out to children.
write_wrapper() {  # tree, folder for the wrapper, program in the tree, wrapper's name
  local tree="$1" folder="$2" program="$3" name="$4"
  local -r wrapper="$tree/$folder/$name"
  local leading=''
  case "$name" in
    # clang would look for its headers beside the linker that started it.
    clang | clang++)
      leading="case \"\${1-}\" in -cc1*) ;; *) set -- -no-canonical-prefixes -resource-dir=\"\$tree/usr/lib/llvm-$LLVM/lib/clang/$LLVM\" \"\$@\" ;; esac"
      ;;
  esac
  {
    echo '#!/bin/sh'
    # shellcheck disable=SC2016
    printf 'tree="${0%%/%s/*}"\n' "$folder"
    [ -z "$leading" ] || printf '%s\n' "$leading"
    # shellcheck disable=SC2016
    printf 'exec "$tree/usr/lib64/ld-linux-x86-64.so.2" --inhibit-cache --library-path "$tree/usr/lib/x86_64-linux-gnu" --argv0 "$0" "$tree/%s" "$@"\n' "$program"
  } >"$wrapper"
  chmod +x "$wrapper"
}

write_wrappers() {  # tree, python
  local tree="$1" python="$2" program name emscripten="$1/usr/share/emscripten"
  mkdir -p "$tree/llvm/bin" "$tree/binaryen/bin" "$tree/bin"
  for program in "$tree/usr/lib/llvm-$LLVM/bin"/*; do
    name="${program##*/}"
    case "$name" in
      clang | clang++ | wasm-ld | llvm-*) write_wrapper "$tree" llvm/bin "usr/lib/llvm-$LLVM/bin/$name" "$name" ;;
    esac
  done
  for program in "$tree"/usr/bin/wasm*; do
    name="${program##*/}"
    case "$name" in *-"$LLVM") ;; *) write_wrapper "$tree" binaryen/bin "usr/bin/$name" "$name" ;; esac
  done

  # Read by Python in Emscripten's own process; relative, so the tree can be moved.
  cat >"$emscripten/.emscripten" <<'CONFIG'
import shutil
from tools.utils import path_from_root
LLVM_ROOT = path_from_root('../../../llvm/bin')
BINARYEN_ROOT = path_from_root('../../../binaryen')
NODE_JS = shutil.which('node') or shutil.which('nodejs')
FROZEN_CACHE = True
CONFIG

  # Emscripten's launchers take the first python3 on PATH: name the good one.
  for program in "$emscripten"/em*.py; do
    name="$(basename "$program" .py)"
    [ -x "$emscripten/$name" ] || continue
    cat >"$emscripten/$name" <<LAUNCHER
#!/bin/sh
unset _PYTHON_SYSCONFIGDATA_NAME
export EM_CONFIG="\${0%/*}/.emscripten"
exec "\${EMSDK_PYTHON:-$python}" -E "\$0.py" "\$@"
LAUNCHER
    # shellcheck disable=SC2016
    printf '#!/bin/sh\nexec "${0%%/*}/../usr/share/emscripten/%s" "$@"\n' "$name" >"$tree/bin/$name"
    chmod +x "$tree/bin/$name"
  done
  # Its JavaScript optimiser imports acorn, which Debian keeps elsewhere.
  mkdir -p "$emscripten/node_modules"
  ln -sfn ../../nodejs/acorn "$emscripten/node_modules/acorn"
  # shellcheck disable=SC2016
  echo 'include("${CMAKE_CURRENT_LIST_DIR}/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake")' \
    >"$tree/emscripten.cmake"
}

# The tree for a machine that brings its own Emscripten.
write_forwarders() {  # tree, emcc
  local tree="$1" folder name root
  folder="$(dirname "$2")"
  mkdir -p "$tree/bin"
  for name in emcc em++ emar emranlib emnm emcmake emconfigure emmake; do
    printf '#!/bin/sh\nexec "%s/%s" "$@"\n' "$folder" "$name" >"$tree/bin/$name"
    chmod +x "$tree/bin/$name"
  done
  root="$("$folder/em-config" EMSCRIPTEN_ROOT)"
  printf 'include("%s/cmake/Modules/Platform/Emscripten.cmake")\n' "$root" >"$tree/emscripten.cmake"
}

check_compiler() {  # tree
  local work="$1/check"
  mkdir -p "$work"
  cat >"$work/check.cpp" <<'CPP'
#include <cstdio>
#include <format>
#include <ranges>
#include <stdexcept>
#include <wasm_simd128.h>
int main() {
  int sum = 0;
  for (int i : std::views::iota(0, 10) | std::views::filter([](int k) { return k % 2; })) sum += i;
  v128_t twice = wasm_f64x2_add(wasm_f64x2_splat(sum), wasm_f64x2_splat(sum));
  try {
    throw std::runtime_error(std::format("{}", wasm_f64x2_extract_lane(twice, 1)));
  } catch (const std::exception& error) {
    std::puts(error.what());
  }
}
CPP
  if ! "$1/bin/em++" -std=c++20 -O2 -msimd128 -fwasm-exceptions "$work/check.cpp" -o "$work/check.js" ||
    [ "$(node "$work/check.js")" != 50 ]; then
    fail "the toolchain in $1 does not compile a small program" "remove that folder and run this script again"
  fi
  rm -rf "$work"
}

# Names the tree after all that decides its content.
tree_path() {  # suitable emcc with version, or nothing
  local key
  key="$({
    printf '%s\n' "$SUITE" "$1" "${COMPILER_PACKAGES[@]}" "${HEADER_PACKAGES[@]}" "${UNUSED_FILES[@]}"
    declare -f unpack write_wrapper write_wrappers write_forwarders
  } | sha256sum | cut -c 1-12)"
  printf '%s/toolchain-%s' "$FORMWRIGHT_CACHE_DIR" "$key"
}

build_tree() {  # tree, suitable emcc with version or nothing
  local tree="$1" emcc="${2% *}" packages=("${HEADER_PACKAGES[@]}") python
  [ "$(dpkg --print-architecture)" = amd64 ] ||
    fail "the private toolchain is made for amd64 only" "put an emcc of at least $MINIMUM_EMCC on PATH"
  [ -n "$emcc" ] || packages+=("${COMPILER_PACKAGES[@]}")
  command -v node >/dev/null || fail "node is missing" "run setup/native.sh first"
  python="$(find_python)"

  local work="$tree.new"
  rm -rf "$work"
  mkdir -p "$work/tree" "$work/debs"
  # shellcheck disable=SC2064  # the path is meant now
  trap "rm -rf '$work'" EXIT

  say "reading the package lists of $SUITE"
  private_apt "$work/apt" "deb $(debian_archive) $SUITE"
  say "fetching ${#packages[@]} packages"
  (cd "$work/debs" && apt-get -qq download "${packages[@]}") ||
    fail "a package of $SUITE could not be fetched" "check the network and run this script again"
  say "unpacking $(du -sh "$work/debs" | cut -f 1)"
  unpack "$work/debs" "$work/tree"

  mkdir "$work/tree/include"
  ln -s ../usr/include/CGAL ../usr/include/boost "$work/tree/include/"
  if [ -n "$emcc" ]; then
    write_forwarders "$work/tree" "$emcc"
  else
    write_wrappers "$work/tree" "$python"
  fi
  say "checking the compiler"
  check_compiler "$work/tree"
  mv "$work/tree" "$tree"
}

main() {
  local emcc tree
  emcc="$(suitable_emcc)"
  tree="$(tree_path "$emcc")"
  if [ "${1-}" != --print-path ] && [ ! -d "$tree" ]; then
    take_lock toolchain
    if [ ! -d "$tree" ]; then  # not made while we waited
      [ -z "$emcc" ] || say "using $emcc of this machine"
      build_tree "$tree" "$emcc"
      say "toolchain ready: $tree ($(du -sh "$tree" | cut -f 1))"
    fi
  fi
  printf '%s\n' "$tree"
}

main "$@"
