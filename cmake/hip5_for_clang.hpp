// Lets the headers of ROCm 5 (Debian) go with a current clang and with toml++.
// Force-included (-include) when compiling with HIP; it does nothing with ROCm 6.
#pragma once
#if defined(__HIP__)
#include <hip/hip_runtime.h>
#if HIP_VERSION_MAJOR < 6

// Defined as a macro before ROCm 5.3, which breaks __attribute__((__noinline__)) in other libraries.
#undef __noinline__

// hip_runtime.h reaches for LLVM intrinsics by names that clang 17 and later no longer know; Kokkos reductions use this one.
inline __device__ unsigned int hip5_atomic_inc(unsigned int* address, unsigned int limit) {
  return __builtin_amdgcn_atomic_inc32(address, limit, __ATOMIC_RELAXED, "agent");
}
#define atomicInc hip5_atomic_inc

#endif
#endif
