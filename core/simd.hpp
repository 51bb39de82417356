// Kokkos' SIMD packs as wide as the processor that this code is compiled for. Kokkos decides by the architecture that it was configured for itself; where that was none (as in
// packages of distributions, and in what ./dev builds), packs would have a single lane and membrane forces take about nine times as long (1.3 instead of 11.6 M vertices/s, double,
// on a busy AMD EPYC, bench_membrane).
#pragma once
#include <Kokkos_Macros.hpp>

#if !defined(KOKKOS_ENABLE_CUDA) && !defined(KOKKOS_ENABLE_HIP) && !defined(KOKKOS_ENABLE_SYCL) && !defined(KOKKOS_ARCH_AVX512XEON) && !defined(KOKKOS_ARCH_AVX2) && \
    !defined(KOKKOS_ARCH_ARM_NEON)
#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
#define KOKKOS_ARCH_AVX512XEON
#elif defined(__AVX2__)
#define KOKKOS_ARCH_AVX2
#elif defined(__ARM_NEON)
#define KOKKOS_ARCH_ARM_NEON
#endif
#endif

#ifdef KOKKOS_SIMD_HPP
#error "include core/simd.hpp instead of Kokkos_SIMD.hpp: all files must agree on the width of packs"
#endif
#include <Kokkos_SIMD.hpp>

namespace corpuscle {

/// As many values as a register of the host holds.
template <class Real>
using HostPack = Kokkos::Experimental::native_simd<Real>;

}  // namespace corpuscle
