// Apart from the rest of placement.cpp, because to_lattice() needs it without random numbers (and so without Kokkos).
#include <cmath>
#include <string>

#include "core/error.hpp"
#include "physics/placement.hpp"

namespace corpuscle {

UnitQuaternion rotation_to_axis(const std::array<double, 3>& axis) {
  const Vector3 direction(axis[0], axis[1], axis[2]);
  const double length = direction.norm();
  if (!(std::isfinite(length) && length > 0))
    throw InputError("The axis of a cell has the length " + std::to_string(length) + ", but must have a direction; correct axis in [[cells]].");
  const Vector3 d = direction / length;
  // Half the rotation by the angle between z and d, about z x d = (-d_y, d_x, 0).
  const double sine = std::hypot(d.x(), d.y());
  if (sine == 0) return d.z() > 0 ? UnitQuaternion{1, 0, 0, 0} : UnitQuaternion{0, 1, 0, 0};
  const double cosine_half = std::sqrt(d.z() > 0 ? (1 + d.z()) / 2 : sine * sine / (2 * (1 - d.z())));  // 1 + d_z without cancellation
  const double sine_half = sine / (2 * cosine_half);
  return {cosine_half, -d.y() / sine * sine_half, d.x() / sine * sine_half, 0};
}

}  // namespace corpuscle
