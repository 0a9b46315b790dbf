# Installs the built tree into a new prefix, then configures, builds and runs its consumers:
#   cmake -DBUILD=... -DSOURCE=... -DWORK=... -DCXX=... -DFLAGS=... -DTYPE=... -P install_consumer.cmake
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE text ERROR_VARIABLE text)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "failed (${code}): ${ARGN}\n${text}")
  endif()
  set(text "${text}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build -G Ninja -DCMAKE_PREFIX_PATH=${WORK}/prefix
  -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${FLAGS} -DCMAKE_BUILD_TYPE=${TYPE})
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/consumer)
message(STATUS "${text}")
run(${WORK}/build/control_cycle)
message(STATUS "${text}")
if(NOT text MATCHES "wrist to [^\n]* mm, ok")
  message(FATAL_ERROR "the example did not say 'wrist to ... mm, ok'")
endif()
run(${CMAKE_COMMAND} -S ${SOURCE}/control -B ${WORK}/control -G Ninja
  -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${FLAGS}
  -DCMAKE_BUILD_TYPE=${TYPE})
run(${CMAKE_COMMAND} --build ${WORK}/control)
run(${WORK}/control/steer)
message(STATUS "${text}")
run(${WORK}/prefix/bin/flextip --version)
message(STATUS "${text}")
file(REMOVE_RECURSE ${WORK})
