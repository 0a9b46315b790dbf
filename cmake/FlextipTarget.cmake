# flextip_library(NAME SOURCES ... [PUBLIC targets...] [PRIVATE targets...]): one library a folder.
# Targets are flextip_<name>, used and exported as flextip::<name>. What is PUBLIC shows in the
# folder's headers; foreign libraries are PRIVATE.
set(FLEXTIP_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion)
# g++ 12 warns of overlapping copies inside std::string where there are none (GCC bug 105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  list(APPEND FLEXTIP_WARNINGS -Wno-restrict)
endif()

function(flextip_options target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE ${FLEXTIP_WARNINGS} $<$<BOOL:${FLEXTIP_WERROR}>:-Werror>)
endfunction()

function(flextip_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(target flextip_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(flextip::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include/flextip>)
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  flextip_options(${target})
  set_property(GLOBAL APPEND PROPERTY FLEXTIP_LIBRARIES ${target})
  set_property(GLOBAL APPEND PROPERTY FLEXTIP_HEADER_FOLDERS ${CMAKE_CURRENT_SOURCE_DIR})
endfunction()

# flextip_tests(NAME SOURCES ... LIBS ...): one test program a folder, every case a ctest entry.
function(flextip_tests name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBS" ${ARGN})
  set(target ${name}_tests)
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE ${ARG_LIBS} GTest::gmock GTest::gtest_main)
  target_compile_definitions(${target} PRIVATE
    FLEXTIP_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    FLEXTIP_SHARED_DIR="${PROJECT_SOURCE_DIR}/../shared")
  flextip_options(${target})
  gtest_discover_tests(${target} TEST_PREFIX "${name}." PROPERTIES TIMEOUT 300 DISCOVERY_TIMEOUT 60)
endfunction()
