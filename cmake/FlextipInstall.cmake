# Installs the program, the libraries, their public headers as <flextip/...>, and the packages for
# find_package and pkg-config. Each library is a component: who asks for flextip::control needs only
# what control needs.
include(CMakePackageConfigHelpers)
include(PublicHeaders)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/flextip)
get_property(libraries GLOBAL PROPERTY FLEXTIP_LIBRARIES)

# Headers name each other by their place in the source tree. Installed, that place is <flextip/...>.
# In the build tree <flextip/...> leads to the source.
foreach(header IN LISTS FLEXTIP_PUBLIC_HEADERS)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/include/flextip/${header}
    CONTENT "#pragma once\n#include \"${PROJECT_SOURCE_DIR}/${header}\"\n" @ONLY)
endforeach()
install(CODE "set(source [[${PROJECT_SOURCE_DIR}]])
  set(headers [[${FLEXTIP_PUBLIC_HEADERS}]])
  set(include \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}/flextip\")
  include([[${CMAKE_CURRENT_LIST_DIR}/InstallHeaders.cmake]])" COMPONENT development)

# flextip_pkg_config(NAME REQUIRES): flextip-NAME.pc. Ceres has no file of its own. The prefix is
# found from the file's own place: a package is installed elsewhere than where it was configured for.
function(flextip_pkg_config name requires)
  file(RELATIVE_PATH to_prefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
  list(JOIN requires " " requires)
  set(libs "-L\${libdir} -lflextip_${name}")
  if(name STREQUAL "calibration")
    string(APPEND libs " -lceres -lglog")
  endif()
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/flextip-${name}.pc CONTENT "prefix=\${pcfiledir}/${to_prefix}
libdir=\${prefix}/${CMAKE_INSTALL_LIBDIR}
includedir=\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}

Name: flextip-${name}
Description: ${PROJECT_DESCRIPTION}: ${name}
Version: ${PROJECT_VERSION}
Requires: ${requires}
Libs: ${libs}
Cflags: -I\${includedir}
" @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/flextip-${name}.pc
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endfunction()

# What a library needs of the others and of foreign packages, from the targets it links.
set(packages_Eigen3::Eigen Eigen3)
set(packages_fmt::fmt fmt)
set(packages_Ceres::ceres Ceres)
set(packages_apriltag::apriltag apriltag)
set(packages_yaml-cpp yaml-cpp)
set(packages_nlohmann_json::nlohmann_json nlohmann_json)
set(packages_TBB::tbb TBB)
set(pc_Eigen3 eigen3)
set(pc_fmt fmt)
set(pc_OpenCV opencv4)
set(pc_apriltag apriltag)
set(pc_yaml-cpp yaml-cpp)
set(pc_nlohmann_json nlohmann_json)
set(pc_TBB tbb)
set(needs "")
foreach(target IN LISTS libraries)
  get_target_property(name ${target} EXPORT_NAME)
  get_target_property(links ${target} LINK_LIBRARIES)
  set(components "")
  set(packages "")
  set(pc_requires "")
  foreach(link IN LISTS links)
    if(link MATCHES "^flextip::(.+)$")
      list(APPEND components ${CMAKE_MATCH_1})
    elseif(link MATCHES "^opencv_|^\\$<")
      if(link MATCHES "^opencv_")
        list(APPEND packages OpenCV)
      endif()
    elseif(link MATCHES "^(av|sw)[a-z]+$")  # FFmpeg's, which have no package of CMake
      list(APPEND pc_requires lib${link})
    elseif(DEFINED packages_${link})
      list(APPEND packages ${packages_${link}})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES packages)
  foreach(component IN LISTS components)
    list(APPEND pc_requires flextip-${component})
  endforeach()
  foreach(package IN LISTS packages)
    list(APPEND pc_requires ${pc_${package}})
  endforeach()
  list(JOIN components " " components)
  list(JOIN packages " " packages)
  string(APPEND needs "set(flextip_${name}_components ${components})\n"
    "set(flextip_${name}_packages ${packages})\n")
  string(APPEND names " ${name}")
  flextip_pkg_config(${name} "${pc_requires}")
  install(TARGETS ${target} EXPORT flextip-${name} ARCHIVE COMPONENT development)
  install(EXPORT flextip-${name} NAMESPACE flextip:: DESTINATION ${package_dir} COMPONENT development)
endforeach()
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/flextip-needs.cmake
  CONTENT "set(flextip_all_components${names})\n${needs}" @ONLY)

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/flextip-config.cmake.in
  ${PROJECT_BINARY_DIR}/flextip-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/flextip-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/flextip-config.cmake ${PROJECT_BINARY_DIR}/flextip-config-version.cmake
  ${PROJECT_BINARY_DIR}/flextip-needs.cmake DESTINATION ${package_dir} COMPONENT development)
