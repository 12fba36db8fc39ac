# What `cmake --install` and the Debian package (`cpack`) hold: the program with its page, man page, completion and
# scenarios, and the libraries and headers that find_package(argil) finds.
if(Python3_FOUND)
  set(share "${PROJECT_BINARY_DIR}/share")
  add_custom_command(OUTPUT "${share}/man/man1/argil.1" "${share}/bash-completion/completions/argil"
    COMMAND "${Python3_EXECUTABLE}" "${PROJECT_SOURCE_DIR}/scripts/make_cli_docs.py" "$<TARGET_FILE:argil>" "${share}"
    DEPENDS argil "${PROJECT_SOURCE_DIR}/scripts/make_cli_docs.py"
    COMMENT "Writing the man page and the completion" VERBATIM)
  add_custom_target(cli_docs ALL DEPENDS "${share}/man/man1/argil.1" "${share}/bash-completion/completions/argil")
  install(DIRECTORY "${share}/man/man1" DESTINATION "${CMAKE_INSTALL_MANDIR}" COMPONENT program)
  install(DIRECTORY "${share}/bash-completion/completions"
    DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion" COMPONENT program)
endif()

install(TARGETS argil COMPONENT program)
install(FILES "${PROJECT_BINARY_DIR}/share/argil/viewer.html"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/argil" COMPONENT program OPTIONAL)  # where node and npm built it
install(DIRECTORY scenarios traces DESTINATION "${CMAKE_INSTALL_DATADIR}/argil" COMPONENT program)
install(FILES README.md DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program)

include(CMakePackageConfigHelpers)
set(package "${CMAKE_INSTALL_LIBDIR}/cmake/argil")
set_target_properties(argil_options PROPERTIES EXPORT_NAME options)
install(TARGETS argil_options EXPORT argil)
# All modules at once: what a program links that takes argil as a whole.
get_property(modules GLOBAL PROPERTY ARGIL_MODULES)
add_library(argil_all INTERFACE)
add_library(argil::argil ALIAS argil_all)
set_target_properties(argil_all PROPERTIES EXPORT_NAME argil)
target_link_libraries(argil_all INTERFACE ${modules})
install(TARGETS argil_all EXPORT argil)
install(EXPORT argil NAMESPACE argil:: FILE argilTargets.cmake DESTINATION "${package}" COMPONENT development)
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/argilConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/argilConfig.cmake" INSTALL_DESTINATION "${package}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/argilConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/argilConfig.cmake" "${PROJECT_BINARY_DIR}/argilConfigVersion.cmake"
  "${CMAKE_CURRENT_LIST_DIR}/FindArgilHDF5.cmake" "${CMAKE_CURRENT_LIST_DIR}/FindCHOLMOD.cmake" DESTINATION "${package}" COMPONENT development)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the authors of argil")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libboost-dev, libeigen3-dev, libhdf5-dev, libsuitesparse-dev, nlohmann-json3-dev, zlib1g-dev, python3-matplotlib")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-h5py, python3-numpy")
set(CPACK_STRIP_FILES ON)
include(CPack)
