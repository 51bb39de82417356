// The nodes around a vertex and their weights: shared by spreading and interpolation, so that the two are adjoint.
#pragma once
#include "core/grid.hpp"
#include "core/types.hpp"

namespace corpuscle {

/// Maps unwrapped positions into the box.
struct PeriodicBox {
  double length[3];
  bool walls;  ///< z is bounded: not wrapped

  explicit PeriodicBox(const Grid& grid, bool walls_in_z) : length{double(grid.nx), double(grid.ny), double(grid.nz)}, walls(walls_in_z) {}
  PeriodicBox() : length{1, 1, 1}, walls(false) {}

  /// Position inside [0, length) along one axis. Beyond a wall, or not a number: the nearest position inside, so that a vertex gone astray
  /// never touches memory outside the field (guards report it).
  KOKKOS_FORCEINLINE_FUNCTION double inside(const double x, const int axis) const {
    const double l = length[axis];
    double wrapped = x;
    if (!(axis == 2 && walls)) wrapped = x - l * Kokkos::floor(x / l);
    const double largest = l * (1 - 1e-15);
    if (!(wrapped >= 0)) return 0;
    return wrapped < largest ? wrapped : largest;
  }
  /// Minimum image of a difference of positions.
  KOKKOS_FORCEINLINE_FUNCTION double nearest(const double dx, const int axis) const {
    if (axis == 2 && walls) return dx;
    return dx - length[axis] * Kokkos::round(dx / length[axis]);
  }
};

template <class Real, class Delta>
struct Stencil {
  int x, y, z;  ///< first node in each direction; may lie in the halo
  Real wx[Delta::width], wy[Delta::width], wz[Delta::width];

  KOKKOS_FORCEINLINE_FUNCTION Stencil(const PeriodicBox& box, const double px, const double py, const double pz) {
    const double s[3] = {box.inside(px, 0) - 0.5, box.inside(py, 1) - 0.5, box.inside(pz, 2) - 0.5};
    const double first[3] = {Delta::first(s[0]), Delta::first(s[1]), Delta::first(s[2])};
    x = static_cast<int>(first[0]);
    y = static_cast<int>(first[1]);
    z = static_cast<int>(first[2]);
    Delta::weights(static_cast<Real>(s[0] - first[0]), wx);
    Delta::weights(static_cast<Real>(s[1] - first[1]), wy);
    Delta::weights(static_cast<Real>(s[2] - first[2]), wz);
  }
};

/// First plane that a vertex at height z touches: decides the slab in coloured spreading.
template <class Delta>
KOKKOS_FORCEINLINE_FUNCTION int first_plane(const PeriodicBox& box, const double pz) {
  return static_cast<int>(Delta::first(box.inside(pz, 2) - 0.5));
}

}  // namespace corpuscle
