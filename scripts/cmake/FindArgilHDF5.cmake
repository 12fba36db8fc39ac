# HDF5's C library without the compiler in C that CMake's own module tries, so that a project in C++ alone finds argil.
# Defines hdf5::hdf5, as that module does. HDF5_ROOT names a place to look first.
find_path(ArgilHDF5_INCLUDE_DIR hdf5.h HINTS "${HDF5_ROOT}" ENV HDF5_ROOT
  PATH_SUFFIXES include hdf5/serial include/hdf5/serial)
find_library(ArgilHDF5_LIBRARY NAMES hdf5_serial hdf5 HINTS "${HDF5_ROOT}" ENV HDF5_ROOT
  PATH_SUFFIXES lib hdf5/serial lib/hdf5/serial)
if(ArgilHDF5_INCLUDE_DIR)
  file(STRINGS "${ArgilHDF5_INCLUDE_DIR}/H5public.h" version REGEX "define H5_VERS_(MAJOR|MINOR|RELEASE)[ \t]")
  string(REGEX REPLACE "[^0-9]*H5_VERS_[A-Z]+[ \t]+([0-9]+)[^;]*" "\\1" version "${version}")
  list(JOIN version "." ArgilHDF5_VERSION)
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(ArgilHDF5
  REQUIRED_VARS ArgilHDF5_LIBRARY ArgilHDF5_INCLUDE_DIR VERSION_VAR ArgilHDF5_VERSION)
if(ArgilHDF5_FOUND AND NOT TARGET hdf5::hdf5)
  add_library(hdf5::hdf5 UNKNOWN IMPORTED)
  set_target_properties(hdf5::hdf5 PROPERTIES
    IMPORTED_LOCATION "${ArgilHDF5_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${ArgilHDF5_INCLUDE_DIR}")
endif()
mark_as_advanced(ArgilHDF5_INCLUDE_DIR ArgilHDF5_LIBRARY)
