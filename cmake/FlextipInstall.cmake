# Installs the libraries, their public headers under include/flextip, and the package flextip.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(libraries GLOBAL PROPERTY FLEXTIP_LIBRARIES)
include(PublicHeaders)
install(TARGETS ${libraries} EXPORT flextip-targets)
foreach(header IN LISTS FLEXTIP_PUBLIC_HEADERS)
  cmake_path(GET header PARENT_PATH folder)
  install(FILES ${PROJECT_SOURCE_DIR}/${header} DESTINATION include/flextip/${folder})
endforeach()
install(EXPORT flextip-targets NAMESPACE flextip:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/flextip)

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/flextip-config.cmake.in
  ${PROJECT_BINARY_DIR}/flextip-config.cmake INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/flextip)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/flextip-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/flextip-config.cmake ${PROJECT_BINARY_DIR}/flextip-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/flextip)
