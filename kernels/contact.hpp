// Short-range repulsion between vertices of different cells, and vertices and walls (MODEL.md, Membrane).
#pragma once
#include <Kokkos_Core.hpp>

namespace corpuscle {

/// Magnitude kappa_int (d^-2 - d_0^-2) for d < d_0, along the connecting line. Below `closest` the force stays at its value there: two vertices
/// at the same place must not get an infinite force.
struct Repulsion {
  double strength;  ///< kappa_int
  double range;     ///< d_0
  static constexpr double closest = 0.1;  ///< in units of the range

  KOKKOS_FORCEINLINE_FUNCTION double magnitude(const double distance) const {
    if (distance >= range) return 0;
    const double d = distance > closest * range ? distance : closest * range;
    return strength * (1 / (d * d) - 1 / (range * range));
  }
};

}  // namespace corpuscle
