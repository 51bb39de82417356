// Loops that are unrolled on every compiler.
#pragma once
#include <Kokkos_Macros.hpp>
#include <type_traits>

namespace corpuscle {

/// Calls f(std::integral_constant<int, 0>) ... f(std::integral_constant<int, N-1>): loops whose tables must be compile-time constants.
template <int N, int I = 0, class F>
KOKKOS_FORCEINLINE_FUNCTION constexpr void unroll(const F& f) {
  if constexpr (I < N) {
    f(std::integral_constant<int, I>{});
    unroll<N, I + 1>(f);
  }
}

}  // namespace corpuscle
