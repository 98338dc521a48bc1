# Catch2 3, the tests' framework: one library, compiled from source with the flags of each build (setup/catch2.sh says where the source is from).
# fw::catch2 has the assertions, fw::catch2_main also the test program's main(); catch_discover_tests comes along.
include_guard(GLOBAL)
include(${CMAKE_CURRENT_LIST_DIR}/compiler.cmake)

execute_process(
  COMMAND ${CMAKE_CURRENT_LIST_DIR}/../setup/catch2.sh --print-path
  OUTPUT_VARIABLE FORMWRIGHT_CATCH2 OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
if(NOT EXISTS ${FORMWRIGHT_CATCH2}/catch_amalgamated.cpp)
  message(FATAL_ERROR "${FORMWRIGHT_CATCH2} is missing: run `make setup` (or setup/catch2.sh)")
endif()

add_library(catch2 STATIC EXCLUDE_FROM_ALL ${FORMWRIGHT_CATCH2}/catch_amalgamated.cpp)
target_compile_definitions(catch2 PRIVATE CATCH_AMALGAMATED_CUSTOM_MAIN)
add_library(catch2_main STATIC EXCLUDE_FROM_ALL ${FORMWRIGHT_CATCH2}/catch2/internal/catch_main.cpp)
target_include_directories(catch2 SYSTEM PUBLIC ${FORMWRIGHT_CATCH2})
target_link_libraries(catch2_main PUBLIC catch2)
add_library(fw::catch2 ALIAS catch2)
add_library(fw::catch2_main ALIAS catch2_main)

include(${FORMWRIGHT_CATCH2}/Catch.cmake)
