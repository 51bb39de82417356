# Where the pinned Kokkos comes from.
#
# include()d: sets CORPUSCLE_KOKKOS_VERSION, _URL and _SHA256 for FetchContent (see Kokkos.cmake).
# As a script (used by ./dev): puts the source tree into DESTINATION,
#   cmake -DDESTINATION=DIR [-DPYTHON=python3] -P cmake/KokkosSource.cmake
# trying the official release first; where only package registries are reachable, the source distribution of
# pycompadre, which carries the same Kokkos release in its folder kokkos/. Both are checked by SHA256.

set(CORPUSCLE_KOKKOS_VERSION 4.5.1)
set(CORPUSCLE_KOKKOS_URL https://github.com/kokkos/kokkos/releases/download/4.5.01/kokkos-4.5.01.tar.gz)
# As published in Spack's recipe for kokkos@4.5.01.
set(CORPUSCLE_KOKKOS_SHA256 52d003ffbbe05f30c89966e4009c017efb1662b02b2b73190670d3418719564c)

set(CORPUSCLE_PYCOMPADRE_VERSION 1.7.6)
set(CORPUSCLE_PYCOMPADRE_SHA256 c766ec4d445ce076069be4b8c51a23ffac4ee79ea949ca86446bfd8c299b154c)

if(NOT CMAKE_SCRIPT_MODE_FILE STREQUAL CMAKE_CURRENT_LIST_FILE)
  return()
endif()

if(NOT DESTINATION)
  message(FATAL_ERROR "say -DDESTINATION=DIR")
endif()
set(work ${DESTINATION}.part)
file(REMOVE_RECURSE ${work})
file(MAKE_DIRECTORY ${work})

# Sets ${unpacked} to TRUE when `archive` has the checksum; its content is then in ${work}/unpacked.
function(unpack archive sha256 unpacked)
  set(${unpacked} FALSE PARENT_SCOPE)
  if(NOT EXISTS ${archive})
    return()
  endif()
  file(SHA256 ${archive} found)
  if(NOT found STREQUAL sha256)
    message(WARNING "${archive}: SHA256 is ${found}, expected ${sha256}; not used")
    return()
  endif()
  file(ARCHIVE_EXTRACT INPUT ${archive} DESTINATION ${work}/unpacked PATTERNS ${ARGN})
  set(${unpacked} TRUE PARENT_SCOPE)
endfunction()

set(tree)
message(STATUS "Kokkos ${CORPUSCLE_KOKKOS_VERSION}: trying ${CORPUSCLE_KOKKOS_URL}")
file(DOWNLOAD ${CORPUSCLE_KOKKOS_URL} ${work}/kokkos.tar.gz INACTIVITY_TIMEOUT 10 TIMEOUT 120 STATUS status)
list(GET status 0 code)
if(code EQUAL 0)
  unpack(${work}/kokkos.tar.gz ${CORPUSCLE_KOKKOS_SHA256} ok)
  if(ok)
    file(GLOB tree ${work}/unpacked/kokkos-*)
  endif()
else()
  list(GET status 1 reason)
  message(STATUS "Kokkos: the release is out of reach (${reason})")
endif()

if(NOT tree AND PYTHON)
  message(STATUS "Kokkos: trying pip download pycompadre==${CORPUSCLE_PYCOMPADRE_VERSION}")
  execute_process(
    COMMAND ${PYTHON} -m pip download --quiet --no-deps --no-binary pycompadre
            pycompadre==${CORPUSCLE_PYCOMPADRE_VERSION} -d ${work}
    RESULT_VARIABLE code)
  if(code EQUAL 0)
    unpack(${work}/pycompadre-${CORPUSCLE_PYCOMPADRE_VERSION}.tar.gz ${CORPUSCLE_PYCOMPADRE_SHA256} ok
           "pycompadre-*/kokkos/*")
    if(ok)
      file(GLOB tree ${work}/unpacked/pycompadre-*/kokkos)
    endif()
  endif()
endif()

if(NOT tree)
  file(REMOVE_RECURSE ${work})
  message(FATAL_ERROR
    "Kokkos ${CORPUSCLE_KOKKOS_VERSION} could not be had: neither the release nor the pip source distribution is "
    "reachable. Install Kokkos 4.5 or newer yourself and set Kokkos_ROOT to its prefix.")
endif()
file(REMOVE_RECURSE ${DESTINATION})
file(RENAME ${tree} ${DESTINATION})
file(REMOVE_RECURSE ${work})
