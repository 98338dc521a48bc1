#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
#
# Fills the prefix of third-party libraries for WebAssembly: compiled ones from
# Debian's source packages of this machine's own release, header-only ones
# copied from the installed -dev packages. So both platforms have the same
# versions. Each library has a stamp named after its recipe and is built once.
#
#   setup/wasm_libraries.sh               build what is missing, print the prefix
#   setup/wasm_libraries.sh --print-path  print the prefix only
#   setup/wasm_libraries.sh LIBRARY...    build these only
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

LIBRARIES=(headers zlib libpng libharu expat pugixml polyclipping stb opencv)
JOBS="${FORMWRIGHT_JOBS:-$(nproc)}"

mapfile -t WASM_FLAGS <"$FORMWRIGHT_ROOT/cmake/wasm_flags.txt"
TOOLCHAIN="$("$FORMWRIGHT_ROOT/setup/wasm_toolchain.sh" --print-path)"
PREFIX="$FORMWRIGHT_CACHE_DIR/wasm-prefix-$(
  { echo "${TOOLCHAIN##*/}" "${WASM_FLAGS[@]}"; host_codename; } | sha256sum | cut -c 1-12
)"
SOURCES="$PREFIX/sources"

# ---- tools of the recipes ---------------------------------------------------

# Reads the lists of source packages that go with this machine's release.
prepare_sources() {
  local lines=() base suite codename
  codename="$(host_codename)"
  while read -r base suite; do
    case "$suite" in "$codename" | "$codename"-updates | "$codename"-security) lines+=("deb-src $base $suite") ;; esac
  done < <(configured_archives)
  private_apt "$SOURCES/apt" "${lines[@]}"
}

# Unpacks a Debian source package, patches applied; sets SOURCE to its folder.
# The security archive drops sources that have moved on to the main one.
# "--tar-only": the program's own archive, without Debian's patches.
fetch_source() {  # package, [--tar-only]
  local folder="$SOURCES/$1" tar_only=("${@:2}")
  rm -rf "$folder"
  mkdir -p "$folder"
  (
    cd "$folder"
    apt-get -qq source "${tar_only[@]}" --only-source "$1" || apt-get -qq source "${tar_only[@]}" --only-source "$1/$(host_codename)"
    [ ${#tar_only[@]} -eq 0 ] || tar -xf ./*.orig.tar.*
  ) >"$folder/log" 2>&1 || {
    tail -n 5 "$folder/log"
    fail "the source of $1 could not be fetched" "check the network and run this script again"
  }
  SOURCE="$(find "$folder" -mindepth 1 -maxdepth 1 -type d | head -n 1)"
}

# Configures, builds and installs a CMake project.
cmake_install() {  # source folder, CMake arguments
  local source="$1" build="$SOURCES/build"
  shift
  rm -rf "$build"
  cmake -G Ninja -S "$source" -B "$build" \
    -DCMAKE_TOOLCHAIN_FILE="$TOOLCHAIN/emscripten.cmake" \
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_FLAGS="${WASM_FLAGS[*]}" -DCMAKE_CXX_FLAGS="${WASM_FLAGS[*]}" \
    -DCMAKE_INSTALL_PREFIX="$PREFIX" -DCMAKE_FIND_ROOT_PATH="$PREFIX" -DBUILD_SHARED_LIBS=OFF \
    -Wno-dev "$@"
  nice cmake --build "$build" -j "$JOBS"
  cmake --install "$build"
  rm -rf "$build"
}

# Compiles sources into lib/lib<name>.a.
static_library() {  # name, then compiler arguments and sources
  local name="$1" objects="$SOURCES/objects" argument flags=() index=0
  shift
  rm -rf "$objects"
  mkdir -p "$objects" "$PREFIX/lib"
  for argument in "$@"; do
    case "$argument" in
      *.c) "$TOOLCHAIN/bin/emcc" -O3 "${WASM_FLAGS[@]}" "${flags[@]}" -c "$argument" -o "$objects/$((index++)).o" ;;
      *.cc | *.cpp) "$TOOLCHAIN/bin/em++" -O3 -std=c++17 "${WASM_FLAGS[@]}" "${flags[@]}" -c "$argument" -o "$objects/$((index++)).o" ;;
      *) flags+=("$argument") ;;
    esac
  done
  rm -f "$PREFIX/lib/lib$name.a"
  "$TOOLCHAIN/bin/emar" rcs "$PREFIX/lib/lib$name.a" "$objects"/*.o
  rm -rf "$objects"
}

# ---- recipes: each installs into $PREFIX ------------------------------------

build_headers() {
  local path
  mkdir -p "$PREFIX/include" "$PREFIX/share"
  for path in /usr/include/nlohmann /usr/include/fast_float /usr/include/eigen3 /usr/include/svgpp /usr/include/exboost; do
    [ -d "$path" ] || fail "$path is missing" "run setup/native.sh first"
    cp -rL --no-preserve=ownership "$path" "$PREFIX/include/"
  done
  # Their CMake packages; they find the headers relative to themselves.
  cp -rL /usr/share/eigen3 /usr/share/cmake "$PREFIX/share/"
}

build_zlib() {
  fetch_source zlib
  # Its CMake file has no switch for the shared library and the examples.
  local names=(adler32 compress crc32 deflate gzclose gzlib gzread gzwrite infback inffast inflate inftrees trees uncompr zutil)
  names=("${names[@]/#/$SOURCE/}")
  static_library z -I"$SOURCE" -DHAVE_UNISTD_H -D_LARGEFILE64_SOURCE=1 "${names[@]/%/.c}"
  install -D -m 644 -t "$PREFIX/include" "$SOURCE/zlib.h" "$SOURCE/zconf.h"
}

build_libpng() {
  fetch_source libpng1.6
  cmake_install "$SOURCE" -DPNG_SHARED=OFF -DPNG_TESTS=OFF -DPNG_ARM_NEON=off -DPNG_INTEL_SSE=off \
    -DZLIB_INCLUDE_DIR="$PREFIX/include" -DZLIB_LIBRARY="$PREFIX/lib/libz.a"
}

build_libharu() {
  # Mirrors have lost the archive of Debian's patches.
  fetch_source libharu --tar-only
  # Debian's configuration of it; its CMake file would look for a zlib and a libpng of the machine's.
  install -D -m 644 -t "$PREFIX/include" "$SOURCE"/include/*.h /usr/include/hpdf_config.h
  static_library hpdf -I"$PREFIX/include" -Wno-everything "$SOURCE"/src/*.c
}

build_expat() {
  fetch_source expat
  # What Debian's build sets; its own configuration asks the compiler for minutes. Random numbers come from the browser.
  : >"$SOURCE/expat/lib/expat_config.h"
  static_library expat -I"$SOURCE/expat/lib" -DBYTEORDER=1234 -DXML_CONTEXT_BYTES=1024 -DXML_DTD -DXML_NS \
    -include unistd.h -DHAVE_ARC4RANDOM_BUF -Darc4random_buf=getentropy \
    "$SOURCE"/expat/lib/{xmlparse,xmlrole,xmltok}.c
  install -D -m 644 -t "$PREFIX/include" "$SOURCE"/expat/lib/expat.h "$SOURCE"/expat/lib/expat_external.h
}

build_pugixml() {
  fetch_source pugixml
  cmake_install "$SOURCE" -DPUGIXML_BUILD_TESTS=OFF
}

build_polyclipping() {
  fetch_source libpolyclipping
  # Its CMake file makes a shared library only.
  install -D -m 644 -t "$PREFIX/include/polyclipping" "$SOURCE"/cpp/clipper.hpp
  static_library polyclipping -I"$PREFIX/include/polyclipping" "$SOURCE"/cpp/clipper.cpp
}

build_stb() {
  # Debian's library, reduced to what is linked: images.
  install -D -m 644 -t "$PREFIX/include/stb" /usr/include/stb/stb_image.h /usr/include/stb/stb_image_write.h
  mkdir -p "$SOURCES/stb"
  cat >"$SOURCES/stb/stb.c" <<'C'
#define STB_IMAGE_IMPLEMENTATION
#include <stb_image.h>
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb_image_write.h>
C
  static_library stb -I"$PREFIX/include/stb" "$SOURCES/stb/stb.c"
}

# The parts that are used, from the same source as natively (setup/opencv.sh).
build_opencv() {
  cmake_install "$FORMWRIGHT_ROOT/setup/opencv" -DOPENCV_SOURCE="$OPENCV_SOURCE" \
    -DZLIB_INCLUDE_DIR="$PREFIX/include" -DCMAKE_INSTALL_LIBDIR=lib
}

# ---- driver -----------------------------------------------------------------

# A stamp changes with the recipe's text (comments aside), not with the others.
stamp_of() {  # library
  printf '%s/stamps/%s-%s' "$PREFIX" "$1" "$({
    declare -f "build_$1" cmake_install static_library
    [ "$1" != opencv ] || grep -hv '^#' "$FORMWRIGHT_ROOT/setup/opencv/CMakeLists.txt" <(grep -E '^(VERSION|SHA256)=' "$FORMWRIGHT_ROOT/setup/opencv.sh")
  } | sha256sum | cut -c 1-12)"
}

# Runs in a shell of its own: `set -e` would be off within an `if` or `||`.
build() {  # library
  local stamp log="$PREFIX/log-$1"
  stamp="$(stamp_of "$1")"
  [ ! -e "$stamp" ] || return 0
  say "building $1 for WebAssembly"
  "build_$1" >"$log" 2>&1 &
  wait $! || {
    tail -n 30 "$log" >&2
    fail "$1 could not be built for WebAssembly" "read $log"
  }
  rm -f "$PREFIX/stamps/$1"-*
  touch "$stamp"
}

main() {
  if [ "${1-}" = --print-path ]; then
    printf '%s\n' "$PREFIX"
    return
  fi
  [ -x "$TOOLCHAIN/bin/emcc" ] || fail "$TOOLCHAIN is missing" "run setup/wasm_toolchain.sh first"
  local chosen=("$@") library missing=()
  [ $# -gt 0 ] || chosen=("${LIBRARIES[@]}")
  for library in "${chosen[@]}"; do
    declare -f "build_$library" >/dev/null || fail "there is no recipe for '$library'" "choose from: ${LIBRARIES[*]}"
    [ -e "$(stamp_of "$library")" ] || missing+=("$library")
  done
  if [ ${#missing[@]} -gt 0 ] || [ ! -e "$PREFIX/complete" ]; then
    take_lock wasm-libraries
    mkdir -p "$PREFIX/stamps" "$SOURCES"
    # Before prepare_sources() puts its package lists in the place of this machine's own.
    OPENCV_SOURCE="$("$FORMWRIGHT_ROOT/setup/opencv.sh" --source)"
    say "reading the lists of source packages"
    prepare_sources
    for library in "${chosen[@]}"; do build "$library"; done
    rm -rf "$SOURCES"
    [ $# -gt 0 ] || touch "$PREFIX/complete"
    say "libraries ready: $PREFIX ($(du -sh "$PREFIX" | cut -f 1))"
  fi
  printf '%s\n' "$PREFIX"
}

main "$@"
