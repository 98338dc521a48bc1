# Third-party libraries under one name each, the same natively and in
# WebAssembly. Natively they come from Debian packages (setup/apt_packages.txt),
# in WebAssembly from the prefix that setup/wasm_libraries.sh fills with the
# same versions; CGAL and Boost headers come from the toolchain tree in both.
include_guard(GLOBAL)
include(${CMAKE_CURRENT_LIST_DIR}/compiler.cmake)

if(EMSCRIPTEN AND NOT EXISTS ${FORMWRIGHT_WASM_PREFIX}/complete)
  message(FATAL_ERROR "${FORMWRIGHT_WASM_PREFIX} is missing or unfinished: run `make setup` (or setup/wasm_libraries.sh)")
endif()

# formwright_dependency(NAME HEADER [LIBRARY] [SUBDIR folder...]): an imported
# target fw::NAME with the folder that holds HEADER and, if given, LIBRARY.
function(formwright_dependency name header)
  cmake_parse_arguments(ARG "" "" "SUBDIR" ${ARGN})
  set(hint "run `make setup`")
  find_path(FW_${name}_INCLUDE_DIR ${header} PATH_SUFFIXES ${ARG_SUBDIR})
  mark_as_advanced(FW_${name}_INCLUDE_DIR)
  if(NOT FW_${name}_INCLUDE_DIR)
    message(FATAL_ERROR "fw::${name}: ${header} was not found; ${hint}")
  endif()
  set(library ${ARG_UNPARSED_ARGUMENTS})
  if(library)
    find_library(FW_${name}_LIBRARY ${library} PATH_SUFFIXES ${ARG_SUBDIR})
    mark_as_advanced(FW_${name}_LIBRARY)
    if(NOT FW_${name}_LIBRARY)
      message(FATAL_ERROR "fw::${name}: library ${library} was not found; ${hint}")
    endif()
    add_library(fw::${name} UNKNOWN IMPORTED GLOBAL)
    set_target_properties(fw::${name} PROPERTIES IMPORTED_LOCATION ${FW_${name}_LIBRARY})
  else()
    add_library(fw::${name} INTERFACE IMPORTED GLOBAL)
  endif()
  # INTERFACE_INCLUDE_DIRECTORIES of an imported target are SYSTEM.
  target_include_directories(fw::${name} INTERFACE ${FW_${name}_INCLUDE_DIR})
endfunction()

# Headers only
find_package(Eigen3 3.4 REQUIRED CONFIG)
find_package(nlohmann_json 3.11 REQUIRED CONFIG)
formwright_dependency(fast_float fast_float/fast_float.h)

# zlib, PNG, PDF, XML (streams of it in 3MF, trees in SVG)
formwright_dependency(zlib zlib.h z)
formwright_dependency(png png.h png)
target_link_libraries(fw::png INTERFACE fw::zlib)
formwright_dependency(hpdf hpdf.h hpdf)
target_link_libraries(fw::hpdf INTERFACE fw::png fw::zlib)
formwright_dependency(expat expat.h expat)
formwright_dependency(pugixml pugixml.hpp pugixml)

# JPEG and other pictures. A compiled library, so nobody defines an *_IMPLEMENTATION macro.
formwright_dependency(stb stb_image.h stb SUBDIR stb)

# Smaller and blurred pictures, outlines of marks: parts of two modules of OpenCV, compiled from one source for both (setup/opencv.sh).
if(NOT EMSCRIPTEN)
  execute_process(
    COMMAND ${CMAKE_CURRENT_LIST_DIR}/../setup/opencv.sh --print-path
    OUTPUT_VARIABLE FORMWRIGHT_OPENCV OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  if(NOT EXISTS ${FORMWRIGHT_OPENCV}/lib/libopencv.a)
    message(FATAL_ERROR "${FORMWRIGHT_OPENCV} is missing: run `make setup` (or setup/opencv.sh)")
  endif()
  if(NOT FORMWRIGHT_OPENCV STREQUAL FW_opencv_PREFIX)  # compiled anew: what was found before is out of date
    unset(FW_opencv_INCLUDE_DIR CACHE)
    unset(FW_opencv_LIBRARY CACHE)
    set(FW_opencv_PREFIX ${FORMWRIGHT_OPENCV} CACHE INTERNAL "")
  endif()
  list(PREPEND CMAKE_PREFIX_PATH ${FORMWRIGHT_OPENCV})
endif()
formwright_dependency(opencv opencv2/core.hpp opencv SUBDIR opencv4)
if(NOT EMSCRIPTEN)
  target_link_libraries(fw::opencv INTERFACE ${CMAKE_DL_LIBS} Threads::Threads)
  target_link_options(fw::opencv INTERFACE -Wl,--gc-sections)  # its files hold functions that call what is not compiled
endif()

# Boost 1.83 headers (Beast and Asio in the native worker, CGAL's own needs).
add_library(fw::boost INTERFACE IMPORTED GLOBAL)
target_include_directories(fw::boost INTERFACE ${FORMWRIGHT_TOOLCHAIN}/include)

# SVG's grammars (SVG++, headers only, over Boost's) and offsets of polygons in whole numbers (Clipper 6).
formwright_dependency(svgpp svgpp/svgpp.hpp)
target_link_libraries(fw::svgpp INTERFACE fw::boost)
formwright_dependency(polyclipping polyclipping/clipper.hpp polyclipping)

# CGAL 6.0.1. Boost's exact numbers instead of GMP's on both platforms, so that
# both compute the same.
add_library(fw::cgal INTERFACE IMPORTED GLOBAL)
target_link_libraries(fw::cgal INTERFACE fw::boost)
target_compile_definitions(fw::cgal INTERFACE CGAL_DISABLE_GMP)
if(EMSCRIPTEN)
  # WebAssembly cannot change the rounding mode: without this, exact
  # predicates are silently wrong.
  target_compile_definitions(fw::cgal INTERFACE CGAL_ALWAYS_ROUND_TO_NEAREST)
else()
  # Interval arithmetic switches the rounding mode behind the compiler's back.
  target_compile_options(fw::cgal INTERFACE -frounding-math)
endif()

if(NOT EMSCRIPTEN)
  # What the worker speaks to printers and machines with: IPP, HTTP, and the pages of a PDF.
  formwright_dependency(cups cups/cups.h cups)
  formwright_dependency(curl curl/curl.h curl)
  formwright_dependency(qpdf qpdf/QPDF.hh qpdf)
  target_compile_definitions(fw::qpdf INTERFACE POINTERHOLDER_TRANSITION=4)

  # Rays. TBB, which Embree builds its tree with, gets as many threads as the job may use.
  option(FORMWRIGHT_EMBREE "Cast rays by Embree" ON)
  find_package(embree 3 REQUIRED CONFIG)
  find_package(TBB REQUIRED CONFIG)
  add_library(fw::embree INTERFACE IMPORTED GLOBAL)
  target_link_libraries(fw::embree INTERFACE embree TBB::tbb)
endif()
