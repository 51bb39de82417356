// The nodes around a vertex and their weights: shared by spreading and interpolation, so that the two are adjoint.
#pragma once
#include "core/grid.hpp"
#include "core/types.hpp"

namespace corpuscle {

/// Maps unwrapped positions into the box.
struct PeriodicBox {
  double length[3];
  double inverse_length[3];
  double largest[3];  ///< the largest position inside
  bool walls;         ///< z is bounded: not wrapped

  PeriodicBox(double length_x, double length_y, double length_z, bool walls_in_z) : length{length_x, length_y, length_z}, walls(walls_in_z) {
    for (int k = 0; k < 3; ++k) {
      inverse_length[k] = 1 / length[k];
      largest[k] = length[k] * (1 - 1e-15);
    }
  }
  explicit PeriodicBox(const Grid& grid, bool walls_in_z) : PeriodicBox(grid.nx, grid.ny, grid.nz, walls_in_z) {}
  PeriodicBox() : PeriodicBox(1, 1, 1, false) {}

  /// Position inside [0, length) along one axis. Beyond a wall, or not a number: a position inside, so that a vertex gone astray
  /// never touches memory outside the field (guards report it). No branch and no division: the loop over vertices vectorises.
  KOKKOS_FORCEINLINE_FUNCTION double inside(const double x, const int axis) const {
    const double turns = axis == 2 && walls ? 0.0 : Kokkos::floor(x * inverse_length[axis]);
    const double wrapped = x - length[axis] * turns;
    const double below = wrapped < largest[axis] ? wrapped : largest[axis];
    return below > 0 ? below : 0;
  }
  /// Minimum image of a difference of positions. No branch and no division: for loops over pairs.
  KOKKOS_FORCEINLINE_FUNCTION double nearest(const double dx, const int axis) const {
    const double inverse = axis == 2 && walls ? 0.0 : inverse_length[axis];
    return dx - length[axis] * Kokkos::nearbyint(dx * inverse);
  }
};

template <class Real, class Delta>
struct Stencil {
  int node;  ///< the first node in each direction; may lie in the halo
  Real wx[Delta::width], wy[Delta::width], wz[Delta::width];
};

/// First node that a vertex touches along one axis, as a coordinate (nodes sit at integers + 1/2), and the weights from there on.
template <class Delta, class Real>
KOKKOS_FORCEINLINE_FUNCTION int stencil_along(const double inside, Real (&weights)[Delta::width]) {
  const double first = Delta::first(inside - 0.5);
  Delta::weights(static_cast<Real>(inside - 0.5 - first), weights);
  return static_cast<int>(first);
}

template <class Real, class Delta>
KOKKOS_FORCEINLINE_FUNCTION Stencil<Real, Delta> stencil_at(const Grid& grid, const PeriodicBox& box, const double x, const double y, const double z) {
  Stencil<Real, Delta> s;
  const int i = stencil_along<Delta>(box.inside(x, 0), s.wx), j = stencil_along<Delta>(box.inside(y, 1), s.wy), k = stencil_along<Delta>(box.inside(z, 2), s.wz);
  s.node = grid.index(i, j, k);
  return s;
}

/// First node that a vertex touches along one axis: decides the pencil in coloured spreading.
template <class Delta>
KOKKOS_FORCEINLINE_FUNCTION int first_node(const PeriodicBox& box, const double position, const int axis) {
  return static_cast<int>(Delta::first(box.inside(position, axis) - 0.5));
}

}  // namespace corpuscle
