# Builds the example programs of OpenIGTLink's authors for serve_tests, where they are installed
# (Debian: openigtlink-examples). StringClient and TrackerClient send one device with a name and
# texts of their own: these become the robot's in a copy. Nothing else of them is changed.
find_path(OPENIGTLINK_EXAMPLES Receiver/ReceiveClient.cxx
  PATHS /usr/share/doc/openigtlink-examples/examples)

# openigtlink_example(NAME MACRO FOLDER [FROM TO]...): serve_tests gets its path as MACRO, empty where
# it is not there.
function(openigtlink_example name macro folder)
  set(file "")
  if(OPENIGTLINK_EXAMPLES)
    file(READ ${OPENIGTLINK_EXAMPLES}/${folder}/${name}.cxx text)
    set(words ${ARGN})
    while(words)
      list(POP_FRONT words from to)
      string(REPLACE "\"${from}\"" "\"${to}\"" text "${text}")
    endwhile()
    file(CONFIGURE OUTPUT openigtlink_examples/${name}.cxx CONTENT "${text}" @ONLY)
    add_executable(${name} ${CMAKE_CURRENT_BINARY_DIR}/openigtlink_examples/${name}.cxx)
    target_compile_options(${name} PRIVATE -w)
    set_target_properties(${name} PROPERTIES CXX_CLANG_TIDY "" UNITY_BUILD OFF)
    target_include_directories(${name} SYSTEM PRIVATE ${OPENIGTLINK_INCLUDE_DIR})
    target_link_libraries(${name} PRIVATE ${OPENIGTLINK_LIBRARY})
    add_dependencies(serve_tests ${name})
    set(file $<TARGET_FILE:${name}>)
  endif()
  target_compile_definitions(serve_tests PRIVATE ${macro}="${file}")
endfunction()

openigtlink_example(ReceiveClient RECEIVE_CLIENT Receiver)
openigtlink_example(TrackerClient TRACKER_CLIENT Tracker Tracker PSM1/servo_cp)
openigtlink_example(StringClient STRING_CLIENT String StringMessage PSM1/state_command
  OpenIGTLink home Network enable)
