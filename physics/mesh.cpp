// Measures of a closed triangulation, and the one-ring tables that membrane kernels walk.
#include "physics/mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "core/error.hpp"

namespace corpuscle {
namespace {

/// Corner opposite to every directed edge (a, b), i.e. c of the face (a, b, c).
class EdgeTable {
 public:
  explicit EdgeTable(const Mesh& mesh) : vertex_count_(static_cast<std::int64_t>(mesh.vertices.size())) {
    corner_.reserve(3 * mesh.faces.size());
    for (const auto& face : mesh.faces)
      for (int c = 0; c < 3; ++c) corner_[key(face[c], face[(c + 1) % 3])] = face[(c + 2) % 3];
  }
  int corner(int a, int b) const {
    const auto found = corner_.find(key(a, b));
    if (found == corner_.end())
      throw InputError("The mesh is not closed and consistently oriented at the edge between vertices " + std::to_string(a) + " and " +
                       std::to_string(b) + " (counted from 0); close and orient it before use.");
    return found->second;
  }

 private:
  std::int64_t key(int a, int b) const { return a * vertex_count_ + b; }
  std::int64_t vertex_count_;
  std::unordered_map<std::int64_t, int> corner_;
};

/// Twice the area vector of a face.
Vector3 face_normal(const Mesh& mesh, const std::array<int, 3>& face) {
  const Vector3& a = mesh.vertices[face[0]];
  return (mesh.vertices[face[1]] - a).cross(mesh.vertices[face[2]] - a);
}

/// Integral of the mean curvature (k1 + k2)/2: half the sum over the edges of length times signed exterior angle (convex: positive).
double integrated_mean_curvature(const Mesh& mesh) {
  const auto& x = mesh.vertices;
  double sum = 0;
  for (const auto& e : mesh_edges(mesh)) sum += (x[e.q] - x[e.p]).norm() * edge_angle(x[e.p], x[e.q], x[e.left], x[e.right]);
  return 0.5 * sum;
}

}  // namespace

std::vector<MeshEdge> mesh_edges(const Mesh& mesh) {
  const EdgeTable table(mesh);
  std::vector<MeshEdge> edges;
  edges.reserve(3 * mesh.faces.size() / 2);
  for (const auto& face : mesh.faces)
    for (int c = 0; c < 3; ++c) {
      const int p = face[c], q = face[(c + 1) % 3];
      if (p < q) edges.push_back({p, q, face[(c + 2) % 3], table.corner(q, p)});
    }
  return edges;
}

double edge_angle(const Vector3& p, const Vector3& q, const Vector3& left, const Vector3& right) {
  const Vector3 left_normal = (q - p).cross(left - p), right_normal = (right - p).cross(q - p);
  return std::atan2(-(q - p).norm() * left_normal.dot(right - p), left_normal.dot(right_normal));
}

double mesh_volume(const Mesh& mesh) {
  double six_volumes = 0;
  const Vector3 origin = mesh.vertices.empty() ? Vector3::Zero() : mesh.vertices.front();  // near the mesh: no cancellation
  for (const auto& face : mesh.faces) six_volumes += face_normal(mesh, face).dot(mesh.vertices[face[0]] - origin);
  return six_volumes / 6;
}

double mesh_area(const Mesh& mesh) {
  double two_areas = 0;
  for (const auto& face : mesh.faces) two_areas += face_normal(mesh, face).norm();
  return two_areas / 2;
}

double mesh_effective_volume(const Mesh& mesh, double shell_thickness) {
  // Steiner: V(h) = V + A h + M h^2 + (4 pi / 3) h^3 with M the integral of the mean curvature, genus 0; exact for a convex body.
  const double h = shell_thickness;
  return mesh_volume(mesh) + h * (mesh_area(mesh) + h * (integrated_mean_curvature(mesh) + h * 4 * std::numbers::pi / 3));
}

Vector3 mesh_centroid(const Mesh& mesh) {
  if (mesh.vertices.empty()) return Vector3::Zero();
  const Vector3 origin = mesh.vertices.front();
  Vector3 moment = Vector3::Zero();
  double six_volumes = 0;
  for (const auto& face : mesh.faces) {  // tetrahedra of the faces and the origin
    const Vector3 a = mesh.vertices[face[0]] - origin, b = mesh.vertices[face[1]] - origin, c = mesh.vertices[face[2]] - origin;
    const double weight = a.dot(b.cross(c));
    six_volumes += weight;
    moment += weight * (a + b + c) / 4;
  }
  return origin + moment / six_volumes;
}

OneRing one_ring(const Mesh& mesh) {
  OneRing ring;
  ring.vertex_count = static_cast<int>(mesh.vertices.size());
  ring.degree.assign(mesh.vertices.size(), 0);
  std::vector<int> first(mesh.vertices.size(), ring.vertex_count);  // the smallest neighbour starts the cycle: a canonical table
  for (const auto& face : mesh.faces)
    for (int c = 0; c < 3; ++c) {
      ++ring.degree[face[c]];
      first[face[c]] = std::min(first[face[c]], face[(c + 1) % 3]);
    }
  ring.max_degree = ring.degree.empty() ? 0 : *std::max_element(ring.degree.begin(), ring.degree.end());

  const EdgeTable table(mesh);
  const std::size_t width = static_cast<std::size_t>(ring.max_degree);
  ring.neighbour.resize(mesh.vertices.size() * width);
  for (int v = 0; v < ring.vertex_count; ++v) {
    const std::size_t row = static_cast<std::size_t>(v) * width;
    int neighbour = first[v];
    for (int i = 0; i < ring.degree[v]; ++i) {
      const int next = table.corner(v, neighbour);
      ring.neighbour[row + i] = neighbour;
      neighbour = next;
      if ((neighbour == first[v]) != (i + 1 == ring.degree[v]))
        throw InputError("The faces around vertex " + std::to_string(v) +
                         " (counted from 0) do not form a single fan; split or remove that vertex so that the surface is manifold.");
    }
    // Padding points at the vertex itself: a kernel that loads a full row stays within the cell.
    for (std::size_t i = ring.degree[v]; i < width; ++i) ring.neighbour[row + i] = v;
  }
  return ring;
}

}  // namespace corpuscle
