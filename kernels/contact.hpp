// Short-range repulsion between vertices of different cells, and vertices and walls (docs/theory/model.md, Membrane).
#pragma once
#include "kernels/stencil.hpp"

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

/// Vector from vertex j to vertex i by the nearest image; `same_image` when no period was added.
struct PairVector {
  double d[3];
  bool same_image;
  KOKKOS_FORCEINLINE_FUNCTION PairVector(const PeriodicBox& box, const VertexVectors& x, const int i, const int j) : same_image(true) {
    for (int k = 0; k < 3; ++k) {
      const double raw = x(i, k) - x(j, k);
      d[k] = box.nearest(raw, k);
      same_image = same_image && d[k] == raw;
    }
  }
  KOKKOS_FORCEINLINE_FUNCTION double squared() const { return d[0] * d[0] + d[1] * d[1] + d[2] * d[2]; }
};

/// Force on vertex i of a pair divided by the distance: F_i = scale d. Zero out of range, for coinciding vertices and where a position is not a number.
KOKKOS_FORCEINLINE_FUNCTION double pair_force_scale(const Repulsion& repulsion, const PairVector& pair) {
  const double squared = pair.squared();
  if (!(squared < repulsion.range * repulsion.range) || squared == 0) return 0;
  const double distance = Kokkos::sqrt(squared);
  return repulsion.magnitude(distance) / distance;
}

}  // namespace corpuscle
