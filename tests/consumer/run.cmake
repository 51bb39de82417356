# Installs BUILD into a scratch prefix, then configures, builds and runs the consumer against it.
set(work ${BUILD}/consumer)
set(source ${CMAKE_CURRENT_LIST_DIR})
file(REMOVE_RECURSE ${work})
foreach(step
    "${CMAKE_COMMAND};--install;${BUILD};--prefix;${work}/installed"
    "${CMAKE_COMMAND};-S;${source};-B;${work}/build;-DCMAKE_PREFIX_PATH=${work}/installed;-DCMAKE_CXX_COMPILER=${CXX};-DKokkos_DIR=${KOKKOS}"
    "${CMAKE_COMMAND};--build;${work}/build"
    "${work}/build/consumer")
  execute_process(COMMAND ${step} RESULT_VARIABLE code)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "failed: ${step}")
  endif()
endforeach()
