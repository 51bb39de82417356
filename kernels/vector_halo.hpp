// Halo of the force and velocity fields: periodic images and no-slip images beyond walls.
#pragma once
#include "core/types.hpp"

namespace corpuscle {

/// Adds `sign` times the halo's force to its partner and clears the halo.
template <class Real>
struct ScatterForce {
  VectorField<Real> force;
  Real sign;  ///< +1 periodic, -1 wall: the image of a force at a no-slip wall has the opposite sign
  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int halo, const int partner, int) const {
    for (int k = 0; k < 3; ++k) {
      force(partner, k) += sign * force(halo, k);
      force(halo, k) = Real(0);
    }
  }
};

/// u_halo = u_partner (periodic).
template <class Real>
struct GatherVelocity {
  VectorField<Real> velocity;
  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int halo, const int partner, int) const {
    for (int k = 0; k < 3; ++k) velocity(halo, k) = velocity(partner, k);
  }
};

/// u_halo = 2 u_wall - u_partner: linear interpolation between the two gives the wall's velocity at the wall.
template <class Real>
struct ExtendVelocity {
  VectorField<Real> velocity;
  Real lower, upper;  ///< wall velocities along x
  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int halo, const int partner, const int side) const {
    velocity(halo, 0) = Real(2) * (side < 0 ? lower : upper) - velocity(partner, 0);
    velocity(halo, 1) = -velocity(partner, 1);
    velocity(halo, 2) = -velocity(partner, 2);
  }
};

}  // namespace corpuscle
