// Where the cells of a suspension start: random centres whose spheres don't overlap, and random orientations.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "physics/mesh.hpp"

namespace corpuscle {

using UnitQuaternion = std::array<double, 4>;  ///< (w, x, y, z)

struct PlacementRequest {
  std::array<double, 3> box{};     ///< lattice units
  bool walls_z = true;             ///< walls at z = 0 and box[2]; else periodic in z as well as in x and y
  std::vector<double> radii;       ///< of the bounding sphere of each cell, lattice units
  double wall_gap = 0;             ///< kept free between spheres and walls
  std::uint64_t seed = 1;
};

struct Placement {
  std::vector<Vector3> centres;              ///< inside the box, in the order of the radii
  std::vector<UnitQuaternion> orientations;  ///< uniformly distributed, independent of the centres and of the number of cells
};

/// Random sequential addition, the largest spheres first; O(N) by a grid. Succeeds for sphere fractions up to about 0.3 (jamming: 0.38).
/// The same request gives the same placement on any machine.
/// @throws InputError when a sphere is too large for the box or finds no place after many trials.
Placement place_spheres(const PlacementRequest& request);

/// Vertices of `mesh` about the origin, scaled, rotated and moved: [V][3] contiguous.
std::vector<double> place_mesh(const Mesh& mesh, const Vector3& centre, const UnitQuaternion& orientation, double scale = 1);

/// Rotation that turns the z axis (symmetry axis of the reference shapes) into `axis` on the shortest way. `axis` needs no unit length.
UnitQuaternion rotation_to_axis(const std::array<double, 3>& axis);

/// Largest distance of a vertex from the origin: the bounding sphere of a cell that is placed by its origin.
double bounding_radius(const Mesh& mesh);

}  // namespace corpuscle
