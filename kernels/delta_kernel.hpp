// Discrete delta functions of the immersed boundary method: weights of the nodes around a vertex along one axis (docs/theory/model.md, Coupling).
// Peskin, Acta Numerica 11, 479 (2002); Roma, Peskin, Berger, J. Comput. Phys. 153, 509 (1999).
#pragma once
#include <Kokkos_Core.hpp>

namespace corpuscle {

/// Each kernel has `width` nodes; `first(s)` is the first of them for a vertex at node coordinate s (nodes at integers), and `weights` fills their
/// weights. All satisfy sum w = 1 and sum (i - s) w_i = 0 for every s; 3 and 4 points also have a constant sum of squares (1/2, 3/8).
struct Delta2 {
  static constexpr int width = 2;
  KOKKOS_FORCEINLINE_FUNCTION static double first(const double s) { return Kokkos::floor(s); }
  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION static void weights(const Real s_minus_first, Real (&w)[2]) {
    w[0] = Real(1) - s_minus_first;
    w[1] = s_minus_first;
  }
};

struct Delta3 {
  static constexpr int width = 3;
  KOKKOS_FORCEINLINE_FUNCTION static double first(const double s) { return Kokkos::floor(s + 0.5) - 1; }
  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION static void weights(const Real s_minus_first, Real (&w)[3]) {
    const Real d = s_minus_first - Real(1);  // in [-1/2, 1/2]
    // The centre from the sum of squares, the sides from the zeroth and first moment: the same function as the formula with two branches.
    w[1] = (Real(1) + Kokkos::sqrt(Real(1) - Real(3) * d * d)) / Real(3);
    w[0] = (Real(1) - w[1] - d) * Real(0.5);
    w[2] = (Real(1) - w[1] + d) * Real(0.5);
  }
};

struct Delta4 {
  static constexpr int width = 4;
  KOKKOS_FORCEINLINE_FUNCTION static double first(const double s) { return Kokkos::floor(s) - 1; }
  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION static void weights(const Real s_minus_first, Real (&w)[4]) {
    const Real d = s_minus_first - Real(1);  // in [0, 1)
    const Real q = Kokkos::sqrt(Real(1) + Real(4) * d * (Real(1) - d));
    w[0] = (Real(3) - Real(2) * d - q) * Real(0.125);
    w[1] = (Real(3) - Real(2) * d + q) * Real(0.125);
    w[2] = (Real(1) + Real(2) * d + q) * Real(0.125);
    w[3] = (Real(1) + Real(2) * d - q) * Real(0.125);
  }
};

}  // namespace corpuscle
