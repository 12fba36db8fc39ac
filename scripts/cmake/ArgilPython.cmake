# Which Python: Debian's own where there is one, for its packages are what scripts/setup installs; another that comes
# first on the path may lack them. -DPython3_EXECUTABLE=… names another.
if(NOT DEFINED Python3_EXECUTABLE AND EXISTS /usr/bin/python3)
  set(Python3_EXECUTABLE /usr/bin/python3)
endif()
find_package(Python3 COMPONENTS Interpreter OPTIONAL_COMPONENTS Development.Module)

option(ARGIL_PYTHON "Build the Python package argil, where pybind11 and Python's headers are found" ON)
set(ARGIL_BUILDS_PYTHON OFF)
if("${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_RELWITHDEBINFO}" MATCHES "-fsanitize")
  message(STATUS "No Python package: an interpreter without sanitizers cannot load one with them")
elseif(ARGIL_PYTHON)
  set(PYBIND11_NOPYTHON ON)  # it would look for a Python of its own
  find_package(pybind11 2.10 CONFIG QUIET)
  if(pybind11_FOUND AND Python3_Development.Module_FOUND)
    set(ARGIL_BUILDS_PYTHON ON)
  else()
    message(STATUS
      "No Python package: pybind11 or Python's headers are missing (Debian: pybind11-dev, python3-dev)")
  endif()
endif()

# Where a build and an installation have the package; both are of use as PYTHONPATH.
set(ARGIL_PYTHON_BUILD "${PROJECT_BINARY_DIR}/python")
set(ARGIL_PYTHON_INSTALL "lib/python3/dist-packages" CACHE STRING
  "Where Python packages are installed, below the prefix")
# Debian's Python looks there in /usr alone; elsewhere, as in /usr/local, in a folder of its version, which then names
# this one.
function(argil_install_python_path)
  set(local "lib/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/dist-packages")
  file(RELATIVE_PATH way "/${local}" "/${ARGIL_PYTHON_INSTALL}")
  install(CODE "if(NOT CMAKE_INSTALL_PREFIX STREQUAL \"/usr\")
    file(WRITE \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${local}/argil.pth\" \"${way}\\n\")
  endif()" COMPONENT python)
endfunction()

# argil_extension(NAME SOURCES a.cpp … HEADERS a.h … DEPENDS base run … SCRIPTS argil/a.py …)
# A folder that Python imports: package argil with the extension _argil and its sources in Python.
function(argil_extension name)
  cmake_parse_arguments(ARG "" "" "SOURCES;HEADERS;DEPENDS;SCRIPTS" ${ARGN})
  Python3_add_library(_argil MODULE WITH_SOABI ${ARG_SOURCES} ${ARG_HEADERS})
  target_link_libraries(_argil PRIVATE argil_options pybind11::headers)
  foreach(folder IN LISTS ARG_DEPENDS)
    target_link_libraries(_argil PRIVATE argil_${folder})
  endforeach()
  # Nothing but the module's entry is for others to link: another extension may hold other versions of the same names.
  target_link_options(_argil PRIVATE "$<$<CXX_COMPILER_ID:GNU,Clang>:LINKER:--exclude-libs,ALL>")
  set_target_properties(_argil PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
    LIBRARY_OUTPUT_DIRECTORY "${ARGIL_PYTHON_BUILD}/argil")
  install(TARGETS _argil LIBRARY DESTINATION "${ARGIL_PYTHON_INSTALL}/argil" COMPONENT python)
  argil_install_python_path()
  set(copies "")
  foreach(script IN LISTS ARG_SCRIPTS)
    set(copy "${ARGIL_PYTHON_BUILD}/${script}")
    add_custom_command(OUTPUT "${copy}"
      COMMAND "${CMAKE_COMMAND}" -E copy "${CMAKE_CURRENT_SOURCE_DIR}/${script}" "${copy}"
      DEPENDS "${script}" COMMENT "" VERBATIM)
    list(APPEND copies "${copy}")
    get_filename_component(folder "${script}" DIRECTORY)
    install(FILES "${script}" DESTINATION "${ARGIL_PYTHON_INSTALL}/${folder}" COMPONENT python)
  endforeach()
  add_custom_target(python ALL DEPENDS _argil ${copies})
endfunction()
