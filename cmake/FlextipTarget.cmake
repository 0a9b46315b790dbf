# How targets are made: one library a folder, one test program a folder, programs of bench/.
#
# flextip_library(NAME SOURCES ... [PUBLIC targets...] [PRIVATE targets...] [COLD]): a library, used
# and exported as flextip::<name>. PUBLIC targets show in the folder's headers; foreign libraries are
# PRIVATE. COLD: nothing in it runs often, so it is optimised less.
include(FlextipUnity)
set(FLEXTIP_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion)
# g++ 12 warns of overlapping and overlong copies inside std::string where there are none (GCC bug
# 105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  list(APPEND FLEXTIP_WARNINGS -Wno-restrict -Wno-stringop-overflow)
endif()
# Several files compiled as one (FlextipUnity.cmake): none of them is the main file any more, and
# g++ then warns of each type in an anonymous namespace.
if(FLEXTIP_UNITY AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  list(APPEND FLEXTIP_WARNINGS -Wno-subobject-linkage)
endif()
# One setting for libraries and programs, so that they share their precompiled headers.
add_compile_options(-fPIC)
set(FLEXTIP_TEST_TIMEOUT_S 300 CACHE STRING "Seconds a test may take")
option(FLEXTIP_TESTS_BY_FOLDER "One ctest entry a test program, not one a case" OFF)

# ccache where there is one. What it does not look at with precompiled headers is told to it here;
# g++ says which header it took only with -fpch-preprocess, and clang writes the time into them unless
# it is told not to.
find_program(FLEXTIP_CCACHE ccache)
if(FLEXTIP_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
    CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
    ${FLEXTIP_CCACHE})
endif()
if(CMAKE_CXX_COMPILER_LAUNCHER AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU"
    AND NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
  add_compile_options(-fpch-preprocess)
elseif(CMAKE_CXX_COMPILER_LAUNCHER AND CMAKE_CXX_COMPILER_ID MATCHES "Clang"
    AND NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
  add_compile_options("SHELL:-Xclang -fno-pch-timestamp")
endif()

# flextip_pch(NAME HEADERS ... LIBS ... [OPTIONS ...]): headers compiled once, for all targets of a kind.
# The warnings belong to it: -Wpedantic undefines macros, and the headers must agree on all of them.
function(flextip_pch name)
  cmake_parse_arguments(ARG "" "" "HEADERS;LIBS;OPTIONS" ${ARGN})
  add_library(flextip_pch_${name} OBJECT ${PROJECT_SOURCE_DIR}/cmake/precompiled.cpp)
  target_link_libraries(flextip_pch_${name} PRIVATE ${ARG_LIBS})
  target_compile_features(flextip_pch_${name} PRIVATE cxx_std_20)
  target_compile_options(flextip_pch_${name} PRIVATE ${FLEXTIP_WARNINGS} ${ARG_OPTIONS})
  target_precompile_headers(flextip_pch_${name} PRIVATE ${ARG_HEADERS})
endfunction()

# flextip_options(TARGET [COLD] [PCH kind]): what all our targets are compiled with.
function(flextip_options target)
  cmake_parse_arguments(ARG "COLD" "PCH" "" ${ARGN})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE ${FLEXTIP_WARNINGS} $<$<BOOL:${FLEXTIP_WERROR}>:-Werror>
    $<$<AND:$<BOOL:${ARG_COLD}>,$<CONFIG:Release>>:-O1>)
  if(NOT ARG_PCH)
    set(ARG_PCH common)
  endif()
  target_precompile_headers(${target} REUSE_FROM flextip_pch_${ARG_PCH})
  flextip_unity(${target})
endfunction()

function(flextip_library name)
  cmake_parse_arguments(ARG "COLD;INTERNAL" "PCH" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(target flextip_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(flextip::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include>)
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  if(ARG_COLD)
    flextip_options(${target} COLD PCH ${ARG_PCH})
  else()
    flextip_options(${target} PCH ${ARG_PCH})
  endif()
  if(NOT ARG_INTERNAL)
    set_property(GLOBAL APPEND PROPERTY FLEXTIP_LIBRARIES ${target})
  endif()
endfunction()

# flextip_tests(NAME SOURCES ... LIBS ...): one test program a folder, every case a ctest entry, or,
# with FLEXTIP_TESTS_BY_FOLDER, the whole program one entry: cases that share a simulation or a
# diagnosis then share it, which is most of the time under sanitizers. SHARDS n makes n entries of it,
# each with its part of the cases, so that a long program is not left alone at the end.
function(flextip_tests name)
  cmake_parse_arguments(ARG "" "SHARDS" "SOURCES;LIBS" ${ARGN})
  set(target ${name}_tests)
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE ${ARG_LIBS} GTest::gmock GTest::gtest_main)
  target_compile_definitions(${target} PRIVATE
    FLEXTIP_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    FLEXTIP_SHARED_DIR="${PROJECT_SOURCE_DIR}/../shared")
  flextip_options(${target} COLD PCH test)
  if(FLEXTIP_TESTS_BY_FOLDER)
    if(NOT ARG_SHARDS)
      set(ARG_SHARDS 1)
    endif()
    foreach(shard RANGE 1 ${ARG_SHARDS})
      math(EXPR index "${shard} - 1")
      set(test ${name}.all_${shard}_of_${ARG_SHARDS})
      add_test(NAME ${test} COMMAND ${target})
      set_tests_properties(${test} PROPERTIES TIMEOUT ${FLEXTIP_TEST_TIMEOUT_S}
        ENVIRONMENT "GTEST_TOTAL_SHARDS=${ARG_SHARDS};GTEST_SHARD_INDEX=${index}")
    endforeach()
  else()
    gtest_discover_tests(${target} TEST_PREFIX "${name}."
      PROPERTIES TIMEOUT ${FLEXTIP_TEST_TIMEOUT_S} DISCOVERY_TIMEOUT 60)
  endif()
endfunction()
