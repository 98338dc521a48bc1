# fw_warnings: link it PRIVATE to every target of ours. Headers of others are
# SYSTEM and stay silent.
include_guard(GLOBAL)
include(${CMAKE_CURRENT_LIST_DIR}/compiler.cmake)

option(FORMWRIGHT_WARNINGS_AS_ERRORS "Stop at warnings in our own code" ON)

add_library(fw_warnings INTERFACE)
target_compile_options(fw_warnings INTERFACE
  $<$<BOOL:${FORMWRIGHT_WARNINGS_AS_ERRORS}>:-Werror>
  -Wall -Wextra $<$<NOT:$<BOOL:$<TARGET_PROPERTY:FORMWRIGHT_NAMES_MAY_HIDE>>>:-Wshadow> -Wconversion -Wnon-virtual-dtor -Woverloaded-virtual
  # Eigen's indices are signed, the standard library's sizes are not.
  -Wno-sign-conversion)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(fw_warnings INTERFACE
    # False alarms of g++ 12 inside inlined Eigen and std::string code.
    -Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread -Wno-restrict
    # Without AVX 32-byte vectors are passed otherwise: only our own functions pass them to each other.
    $<$<NOT:$<BOOL:${FORMWRIGHT_X86_64_V3}>>:-Wno-psabi>)
endif()
