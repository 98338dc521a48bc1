# The headers that nearly every file of ours reads take a third to most of the
# time that compiling it takes. In the builds that tests run from
# (CMakePresets.json) they are read once, and kept outside the checkout, so that
# what ccache has serves every checkout. The fuzz preset does without, which
# shows that every file includes what it needs.
#
# A target whose own flags change what the compiler would make of the headers
# (-mno-fma, -frounding-math) says so by FORMWRIGHT_OWN_CODE_FLAGS.
include_guard(GLOBAL)
include(${CMAKE_CURRENT_LIST_DIR}/compiler.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/catch2.cmake)

option(FORMWRIGHT_PRECOMPILE "Precompile the headers that nearly every file reads" OFF)
if(NOT FORMWRIGHT_PRECOMPILE)
  function(formwright_begin_with)
  endfunction()
  return()
endif()

# formwright_precompile(RESULT HEADER flags...): sets RESULT to the flag that
# makes a file begin with precompiled/HEADER, compiled with those of every target.
function(formwright_precompile result header)
  set(source ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/precompiled/${header})
  string(TOUPPER ${CMAKE_BUILD_TYPE} type)
  separate_arguments(flags UNIX_COMMAND "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${type}}")
  get_directory_property(options COMPILE_OPTIONS)
  list(FILTER options EXCLUDE REGEX "prefix-map")  # names the checkout
  list(APPEND flags ${options} -std=c++${CMAKE_CXX_STANDARD} ${ARGN})
  foreach(library Eigen3::Eigen nlohmann_json::nlohmann_json fw::boost)
    get_target_property(folders ${library} INTERFACE_INCLUDE_DIRECTORIES)
    list(REMOVE_ITEM folders /usr/include)  # named once more it would come before the compiler's own
    list(TRANSFORM folders PREPEND "-isystem" OUTPUT_VARIABLE folders)
    list(APPEND flags ${folders})
  endforeach()
  # What the compiler reads, and how, names the folder.
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} ${flags} -x c++ -E -P ${source} OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
  string(SHA256 key "${CMAKE_CXX_COMPILER} ${CMAKE_CXX_COMPILER_VERSION} ${flags} ${text}")
  string(SUBSTRING ${key} 0 12 short_key)
  set(folder ${FORMWRIGHT_CACHE_DIR}/precompiled-${short_key})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    set(made ${folder}/${header}.gch)
    set(use "-include ${folder}/${header} -Winvalid-pch")
  else()
    set(made ${folder}/${header}.pch)
    set(use "-include-pch ${made}")
  endif()
  if(NOT EXISTS ${made})
    message(STATUS "Precompiling ${header}")
    string(RANDOM LENGTH 8 part)
    file(COPY ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/precompiled/ DESTINATION ${folder})
    file(WRITE ${made}.sum ${key})  # ccache takes it for the content
    execute_process(COMMAND ${CMAKE_CXX_COMPILER} ${flags} -x c++-header ${folder}/${header} -o ${made}.${part} COMMAND_ERROR_IS_FATAL ANY)
    file(RENAME ${made}.${part} ${made})
  endif()
  set(${result} ${use} PARENT_SCOPE)
endfunction()

formwright_precompile(core_header core.h)
if(FORMWRIGHT_TESTS)
  formwright_precompile(FORMWRIGHT_TEST_HEADER test.h -isystem${FORMWRIGHT_CATCH2})
endif()
set(own_flags $<BOOL:$<TARGET_PROPERTY:FORMWRIGHT_OWN_CODE_FLAGS>>)
set(other_header $<BOOL:$<TARGET_PROPERTY:FORMWRIGHT_PRECOMPILED>>)
set(is_cxx $<COMPILE_LANGUAGE:CXX>)
add_compile_options("SHELL:$<$<AND:${is_cxx},$<NOT:${own_flags}>,$<NOT:${other_header}>>:${core_header}>")

# formwright_begin_with(TARGET FLAG): another header than core.h, one of those above.
function(formwright_begin_with target flag)
  set_target_properties(${target} PROPERTIES FORMWRIGHT_PRECOMPILED ON)
  target_compile_options(${target} PRIVATE "SHELL:$<$<AND:$<COMPILE_LANGUAGE:CXX>,$<NOT:$<BOOL:$<TARGET_PROPERTY:FORMWRIGHT_OWN_CODE_FLAGS>>>>:${flag}>")
endfunction()
