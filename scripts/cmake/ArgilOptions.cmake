# Flags every target of the project shares. Determinism decides them: no contraction into fused
# multiply-adds, no fast-math, no code for this machine's processor only.
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Debug or Release" FORCE)
endif()
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")

add_library(argil_options INTERFACE)
target_compile_features(argil_options INTERFACE cxx_std_20)
target_compile_definitions(argil_options INTERFACE EIGEN_DONT_PARALLELIZE)
target_compile_options(argil_options INTERFACE
  -ffp-contract=off
  -fno-semantic-interposition  # calls within a library are inlined as in a program
  "$<BUILD_INTERFACE:-Wall;-Wextra;-Wpedantic;-Wshadow;-Wconversion;-Wdouble-promotion;-Wold-style-cast>"
  "$<BUILD_INTERFACE:-Wnon-virtual-dtor;-Woverloaded-virtual>"
  # g++ 12 warns of "literal" + std::string (GCC bug 105651)
  "$<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>>")
target_include_directories(argil_options INTERFACE "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>")
