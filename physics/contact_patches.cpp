#include "physics/contact_patches.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "physics/placement.hpp"

namespace corpuscle {
namespace {

constexpr double rounding = 1e-9;  // mirror images of a vertex differ by rounding: both or none must be within reach

/// Where the ray from `origin` along the unit vector `along` leaves the mesh for good: its last crossing with a face.
Vector3 exit_point(const Mesh& mesh, const Vector3& origin, const Vector3& along) {
  // A ray through an edge hits both faces or, by rounding, neither: let it hit both.
  double farthest = 0;
  for (const auto& face : mesh.faces) {
    const Vector3& a = mesh.vertices[face[0]];
    const Vector3 ab = mesh.vertices[face[1]] - a, ac = mesh.vertices[face[2]] - a, from_a = origin - a;
    const Vector3 h = along.cross(ac), q = from_a.cross(ab);
    const double determinant = ab.dot(h);
    if (determinant == 0) continue;
    const double u = from_a.dot(h) / determinant, v = along.dot(q) / determinant;
    if (u >= -rounding && v >= -rounding && u + v <= 1 + rounding) farthest = std::max(farthest, ac.dot(q) / determinant);
  }
  return origin + farthest * along;
}

std::vector<int> vertices_within(const Mesh& mesh, const Vector3& point, double reach) {
  std::vector<int> found;
  for (int v = 0; v < int(mesh.vertices.size()); ++v)
    if ((mesh.vertices[v] - point).norm() <= reach) found.push_back(v);
  return found;
}

double smallest_distance(const Mesh& mesh, const Vector3& point) {
  double smallest = std::numeric_limits<double>::max();
  for (const Vector3& v : mesh.vertices) smallest = std::min(smallest, (v - point).norm());
  return smallest;
}

}  // namespace

ContactPatches contact_patches(const Mesh& reference, const Vector3& direction, double diameter) {
  const Vector3 along = direction.normalized(), centre = mesh_centroid(reference);
  const Vector3 ahead = exit_point(reference, centre, along), behind = exit_point(reference, centre, -along);
  const double reach = diameter / 2 * (1 + rounding);
  return {vertices_within(reference, ahead, reach), vertices_within(reference, behind, reach),
          2 * std::max(smallest_distance(reference, ahead), smallest_distance(reference, behind)), (ahead - behind).norm()};
}

Vector3 direction_in_reference(const CellSpec& spec) {
  const Vector3 lab(spec.stretch.direction[0], spec.stretch.direction[1], spec.stretch.direction[2]);
  if (!spec.axis) return lab;
  const UnitQuaternion turn = rotation_to_axis(*spec.axis);
  return Eigen::Quaterniond(turn[0], turn[1], turn[2], turn[3]).conjugate() * lab;
}

}  // namespace corpuscle
