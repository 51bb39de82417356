# One library per room (core, kernels, physics, io): headers only when the room has no sources.
#
#   corpuscle_room(ROOM SOURCES file... USES target...)
#
# makes the target corpuscle_ROOM, called corpuscle::ROOM by those who link it. Code includes "room/header.hpp".

# What changes generated code. Header-only kernels are compiled by whoever includes them, so these travel with the
# targets, also into an installed package. Reassociation (-ffast-math) stays off: runs are bit for bit reproducible and
# the NaN guards must work.
set(CORPUSCLE_CODE_OPTIONS -fno-math-errno -fno-trapping-math)
set(host_options -fopenmp-simd)
if(CORPUSCLE_NATIVE)
  list(APPEND host_options -march=native)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND NOT Kokkos_ENABLE_CUDA AND NOT Kokkos_ENABLE_HIP)
    # Collision with a force field is up to 1.2 times faster with 256 than with 512 bits on AMD's Zen 4 (docs/performance.md); Intel's processors
    # get this width from GCC anyway. Packs of cells (core/simd.hpp) keep the full width.
    list(APPEND host_options -mprefer-vector-width=256)
  endif()
endif()
foreach(option IN LISTS host_options)
  if(Kokkos_ENABLE_HIP)
    set(option "SHELL:-Xarch_host ${option}")
  endif()
  list(APPEND CORPUSCLE_CODE_OPTIONS ${option})
endforeach()
add_compile_definitions(EIGEN_NO_CUDA EIGEN_NO_HIP)  # Eigen stays on the host
if(Kokkos_ENABLE_CUDA)
  list(APPEND CORPUSCLE_CODE_OPTIONS --expt-relaxed-constexpr)  # constexpr functions in kernels
  add_compile_definitions(FMT_USE_CONSTEXPR=1 FMT_CONSTEVAL=)   # fmt 9 thinks too little, then too much, of nvcc
endif()

set(CORPUSCLE_WARNINGS -Wall -Wextra)
if(CMAKE_CXX_COMPILER_ID MATCHES Clang)
  list(APPEND CORPUSCLE_WARNINGS -Wno-pass-failed)  # a simd hint not followed is no defect
elseif(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  list(APPEND CORPUSCLE_WARNINGS -Wno-restrict)  # wrong about std::string + "text" (GCC bug 105651)
endif()

function(corpuscle_room room)
  cmake_parse_arguments(arg "" "" "SOURCES;USES" ${ARGN})
  set(target corpuscle_${room})
  if(arg_SOURCES)
    set(scope PUBLIC)
    add_library(${target} STATIC ${arg_SOURCES})
    target_compile_options(${target} PRIVATE ${CORPUSCLE_WARNINGS})
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  else()
    set(scope INTERFACE)
    add_library(${target} INTERFACE)
  endif()
  add_library(corpuscle::${room} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${room})
  target_link_libraries(${target} ${scope} ${arg_USES})
  target_include_directories(${target} ${scope}
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/corpuscle>)

  install(TARGETS ${target} EXPORT corpuscle ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${room} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/corpuscle
          FILES_MATCHING PATTERN "*.hpp")
endfunction()
