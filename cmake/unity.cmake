# Files that are compiled in groups read and instantiate their headers once a
# group: two thirds of the processor time, in light folders less than half. The
# fuzz preset compiles core's files alone, which shows that each can be.
#
# A target of heavy files takes smaller groups (UNITY_BUILD_BATCH_SIZE), so that
# one edit costs at most half a minute.
include_guard(GLOBAL)

option(FORMWRIGHT_UNITY "Compile the files of a target in groups" OFF)
set(CMAKE_UNITY_BUILD ${FORMWRIGHT_UNITY})
set(CMAKE_UNITY_BUILD_BATCH_SIZE 8)

# formwright_compile_alone(FILE...): not in a group. Files that take long by themselves begin early this way.
function(formwright_compile_alone)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
