# Installs the libraries, their headers under include/flextip/, and the package flextip.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(libraries GLOBAL PROPERTY FLEXTIP_LIBRARIES)
get_property(folders GLOBAL PROPERTY FLEXTIP_HEADER_FOLDERS)
list(REMOVE_DUPLICATES folders)
install(TARGETS ${libraries} EXPORT flextip-targets)
foreach(folder IN LISTS folders)
  cmake_path(GET folder FILENAME name)
  install(DIRECTORY ${folder}/ DESTINATION include/flextip/${name} FILES_MATCHING PATTERN "*.h")
endforeach()
install(EXPORT flextip-targets NAMESPACE flextip:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/flextip)

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/flextip-config.cmake.in
  ${PROJECT_BINARY_DIR}/flextip-config.cmake INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/flextip)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/flextip-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/flextip-config.cmake ${PROJECT_BINARY_DIR}/flextip-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/flextip)
