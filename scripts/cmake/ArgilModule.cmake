# argil_module(NAME SOURCES a.cpp … HEADERS a.h … DEPENDS base mesh … [LIBRARIES external::target …])
# One static library a folder of src/. DEPENDS are the folders it may include; every header is compiled
# once on its own, so that a header which forgets an include fails here.
function(argil_module name)
  cmake_parse_arguments(ARG "" "" "SOURCES;HEADERS;DEPENDS;LIBRARIES" ${ARGN})
  set(target argil_${name})
  if(ARG_SOURCES)
    set(scope PUBLIC)
    add_library(${target} STATIC ${ARG_SOURCES})
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)  # the Python module holds them
    argil_use_precompiled(${target} argil_precompiled)
  else()
    set(scope INTERFACE)
    add_library(${target} INTERFACE)
  endif()
  target_sources(${target} ${scope} FILE_SET HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}/src" FILES ${ARG_HEADERS})
  set_target_properties(${target} PROPERTIES VERIFY_INTERFACE_HEADER_SETS ON)
  target_link_libraries(${target} ${scope} argil_options)
  foreach(folder IN LISTS ARG_DEPENDS)
    target_link_libraries(${target} ${scope} argil_${folder})
  endforeach()
  if(ARG_LIBRARIES)
    target_link_libraries(${target} ${scope} ${ARG_LIBRARIES})
  endif()
  if(name STREQUAL cli)  # the program's own
    return()
  endif()
  set_property(GLOBAL APPEND PROPERTY ARGIL_MODULES ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})  # argil::NAME for those who link it
  install(TARGETS ${target} EXPORT argil COMPONENT development
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}/argil" FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/argil")
endfunction()

# What only asks the modules is compiled as fast as its optimizer lets it: half of a clean build is tests.
function(argil_optimize_little target)
  target_compile_options(${target} PRIVATE "$<$<CONFIG:Release>:-O1>")
endfunction()

# argil_test(NAME LABEL label … SOURCES a.cpp … DEPENDS mesh …)
# One GoogleTest program; every TEST in it becomes a ctest entry that carries the labels.
function(argil_test name)
  cmake_parse_arguments(ARG "" "" "LABELS;SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  argil_use_precompiled(${name} argil_tests_precompiled)
  argil_optimize_little(${name})
  target_link_libraries(${name} PRIVATE argil_options argil_test_support GTest::gtest GTest::gtest_main)
  foreach(folder IN LISTS ARG_DEPENDS)
    target_link_libraries(${name} PRIVATE argil_${folder})
  endforeach()
  # gtest_discover_tests splits a list of labels; they are set from the list of tests that it leaves behind instead.
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 TEST_LIST ${name}_tests)
  set(labels_file "${CMAKE_CURRENT_BINARY_DIR}/${name}_labels.cmake")
  file(WRITE "${labels_file}" "if(${name}_tests)
  set_tests_properties(\${${name}_tests} PROPERTIES LABELS \"${ARG_LABELS}\" TIMEOUT 600)
endif()
")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${labels_file}")
endfunction()
