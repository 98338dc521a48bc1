# Flags that every target of every build shares, the compiler cache, sanitizers.
include_guard(GLOBAL)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

# Slow products that outlive a checkout; the same rule as setup/common.sh.
if(DEFINED ENV{FORMWRIGHT_CACHE})
  set(FORMWRIGHT_CACHE_DIR "$ENV{FORMWRIGHT_CACHE}")
elseif(DEFINED ENV{XDG_CACHE_HOME})
  set(FORMWRIGHT_CACHE_DIR "$ENV{XDG_CACHE_HOME}/formwright")
else()
  set(FORMWRIGHT_CACHE_DIR "$ENV{HOME}/.cache/formwright")
endif()

# Where CGAL 6 and Boost 1.83 are, natively too, and Emscripten.
if(NOT DEFINED FORMWRIGHT_TOOLCHAIN)
  execute_process(
    COMMAND ${CMAKE_CURRENT_LIST_DIR}/../setup/wasm_toolchain.sh --print-path
    OUTPUT_VARIABLE FORMWRIGHT_TOOLCHAIN OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
endif()
if(NOT EXISTS ${FORMWRIGHT_TOOLCHAIN}/include/CGAL)
  message(FATAL_ERROR "${FORMWRIGHT_TOOLCHAIN} is missing: run `make setup` (or setup/wasm_toolchain.sh)")
endif()

# Results are compared between native and WebAssembly: no fused multiply-add
# that the source does not ask for. (WebAssembly: cmake/wasm_flags.txt has it.)
if(NOT EMSCRIPTEN)
  add_compile_options(-ffp-contract=off)

  file(READ /proc/cpuinfo cpuinfo)
  if(cpuinfo MATCHES " avx2 " AND cpuinfo MATCHES " fma ")
    set(has_x86_64_v3 ON)
  else()
    set(has_x86_64_v3 OFF)
  endif()
  option(FORMWRIGHT_X86_64_V3 "Use AVX2 and FMA; ON where this processor has them" ${has_x86_64_v3})
  if(FORMWRIGHT_X86_64_V3)
    add_compile_options(-march=x86-64-v3)
  endif()
endif()

if(EMSCRIPTEN)
  # Meshes do not fit into the default 16 MB, deep recursion not into 64 kB.
  add_link_options(-sALLOW_MEMORY_GROWTH=1 -sMAXIMUM_MEMORY=4GB -sSTACK_SIZE=4MB)
endif()

option(FORMWRIGHT_SANITIZE "Address and undefined behaviour sanitizers" OFF)
if(FORMWRIGHT_SANITIZE)
  # Debug information without this folder's name: what ccache has serves every checkout.
  add_compile_options(-fdebug-prefix-map=${CMAKE_SOURCE_DIR}=.)
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
  # A third of the compile time. The address sanitizer reports the bad accesses that null pointers, wrong types and sizes lead to.
  if(DEFINED FORMWRIGHT_CRAFT_TESTS AND NOT FORMWRIGHT_CRAFT_TESTS)
    add_compile_options(-fno-sanitize=null,alignment,vptr,object-size)
  endif()
endif()

# formwright_fuzz(NAME SOURCES file... LIBRARIES target...): a libFuzzer program
# fuzz_NAME. Nothing in other builds; `make fuzz` builds and runs them.
option(FORMWRIGHT_FUZZ "Build the fuzz targets (clang only)" OFF)
if(FORMWRIGHT_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)
  add_custom_target(fuzz)
endif()
function(formwright_fuzz name)
  if(NOT FORMWRIGHT_FUZZ)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(fuzz_${name} EXCLUDE_FROM_ALL ${ARG_SOURCES})
  target_link_libraries(fuzz_${name} PRIVATE ${ARG_LIBRARIES} fw_warnings)
  target_link_options(fuzz_${name} PRIVATE -fsanitize=fuzzer)
  add_dependencies(fuzz fuzz_${name})
endfunction()

# Emscripten's compilers are wrapped as a whole: a hit then costs 30 ms instead
# of Python and clang. ccache cannot tell from their names what they are, and
# would take a launcher script of ten lines for the compiler's identity.
find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(launcher ${CMAKE_COMMAND} -E env CCACHE_DIR=${FORMWRIGHT_CACHE_DIR}/ccache CCACHE_BASEDIR=${CMAKE_SOURCE_DIR}
      CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_PCH_EXTSUM=1  # cmake/precompiled.cmake
      CCACHE_DEPEND=1)  # what the compiler lists as read is taken: no run of the preprocessor before it
  if(EMSCRIPTEN)
    list(APPEND launcher CCACHE_COMPILERTYPE=clang CCACHE_COMPILERCHECK=string:${FORMWRIGHT_TOOLCHAIN})
  endif()
  list(APPEND launcher ${CCACHE_PROGRAM})
  set(CMAKE_C_COMPILER_LAUNCHER ${launcher})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${launcher})
endif()
