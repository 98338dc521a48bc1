# CMake toolchain file of the WebAssembly build. CMake reads it several times.
if(NOT DEFINED FORMWRIGHT_TOOLCHAIN)
  execute_process(
    COMMAND ${CMAKE_CURRENT_LIST_DIR}/../setup/wasm_toolchain.sh --print-path
    OUTPUT_VARIABLE FORMWRIGHT_TOOLCHAIN OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  if(NOT EXISTS ${FORMWRIGHT_TOOLCHAIN}/emscripten.cmake)
    message(FATAL_ERROR "${FORMWRIGHT_TOOLCHAIN} is missing: run `make setup` (or setup/wasm_toolchain.sh)")
  endif()
  execute_process(
    COMMAND ${CMAKE_CURRENT_LIST_DIR}/../setup/wasm_libraries.sh --print-path
    OUTPUT_VARIABLE FORMWRIGHT_WASM_PREFIX OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
endif()

# Tests run under the node of PATH (Emscripten would prefer Debian's `nodejs`).
find_program(CMAKE_CROSSCOMPILING_EMULATOR node REQUIRED)

include(${FORMWRIGHT_TOOLCHAIN}/emscripten.cmake)

# One list of flags for our code and for the libraries (setup/wasm_libraries.sh).
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/wasm_flags.txt wasm_flags)
list(JOIN wasm_flags " " wasm_flags)
set(CMAKE_C_FLAGS_INIT "${wasm_flags}")
set(CMAKE_CXX_FLAGS_INIT "${wasm_flags}")

# Libraries come from our prefix or from Emscripten, never from the host.
list(APPEND CMAKE_FIND_ROOT_PATH ${FORMWRIGHT_WASM_PREFIX})
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
