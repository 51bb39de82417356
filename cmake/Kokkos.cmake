# Kokkos 4.5 or newer: an installed one (Kokkos_ROOT, CMAKE_PREFIX_PATH), else the pinned release, built with this project.
# Where the release cannot be downloaded either, ./dev builds the same Kokkos from a package registry.
find_package(Kokkos 4.5 QUIET)
if(NOT Kokkos_FOUND)
  find_package(Kokkos 5 QUIET)
endif()

# Small headers that mend what device toolkits broke; they do nothing where there is nothing to mend.
if(Kokkos_ENABLE_CUDA)
  add_compile_options("$<$<COMPILE_LANGUAGE:CXX>:SHELL:-include ${CMAKE_CURRENT_LIST_DIR}/cuda13_for_kokkos.hpp>")
elseif(Kokkos_ENABLE_HIP)
  add_compile_options("$<$<COMPILE_LANGUAGE:CXX>:SHELL:-include ${CMAKE_CURRENT_LIST_DIR}/hip5_for_clang.hpp>")
endif()

if(Kokkos_FOUND)
  message(STATUS "Kokkos ${Kokkos_VERSION} in ${Kokkos_DIR}, devices: ${Kokkos_DEVICES}")
else()
  include(FetchContent)
  include(${CMAKE_CURRENT_LIST_DIR}/KokkosSource.cmake)
  message(STATUS "No Kokkos found, fetching release ${CORPUSCLE_KOKKOS_VERSION}")
  option(Kokkos_ENABLE_SERIAL "" ON)
  option(Kokkos_ENABLE_OPENMP "" ON)
  option(Kokkos_ENABLE_DEPRECATED_CODE_4 "" OFF)
  FetchContent_Declare(Kokkos URL ${CORPUSCLE_KOKKOS_URL} URL_HASH SHA256=${CORPUSCLE_KOKKOS_SHA256})
  FetchContent_MakeAvailable(Kokkos)
endif()
