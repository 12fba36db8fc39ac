# What nearly every source includes, compiled once for all modules and once for all tests: it takes longer to read than
# what follows it. A source still includes all that it uses; builds without this (scripts/fuzz, ccache) find one that does not.
if(CMAKE_CXX_COMPILER_LAUNCHER)
  set(default OFF)  # ccache keeps no objects that are made so
else()
  set(default ON)
endif()
option(ARGIL_PRECOMPILED_HEADERS "Compile what nearly every source includes once" ${default})

set(often_included <algorithm> <array> <chrono> <cmath> <filesystem> <fstream> <functional> <limits> <map> <memory> <numbers>
  <numeric> <optional> <sstream> <string> <vector> <Eigen/Dense>)

# argil_precompile(NAME LIBRARIES external::target … HEADERS <header> …)
function(argil_precompile name)
  if(NOT ARGIL_PRECOMPILED_HEADERS)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "LIBRARIES;HEADERS" ${ARGN})
  set(source "${PROJECT_BINARY_DIR}/${name}.cpp")
  file(GENERATE OUTPUT "${source}" CONTENT "")
  add_library(${name} OBJECT "${source}")
  target_link_libraries(${name} PRIVATE argil_options ${ARG_LIBRARIES})
  target_precompile_headers(${name} PRIVATE ${ARG_HEADERS})
endfunction()

# argil_use_precompiled(TARGET NAME)
function(argil_use_precompiled target name)
  if(ARGIL_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} REUSE_FROM ${name})
    # g++ 12 takes lines of the standard library for ours there and warns of lengths and bounds that cannot be (see
    # -Wno-restrict); builds without this have both warnings.
    target_compile_options(${target} PRIVATE "$<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow;-Wno-array-bounds>")
  endif()
endfunction()
