#include "physics/stability_limits.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace corpuscle {
namespace {

const double speed_of_sound = 1 / std::sqrt(3.0);

}  // namespace

double squared_curvature(const Mesh& mesh) {
  std::vector<Vector3> gradient(mesh.vertices.size(), Vector3::Zero());
  for (const auto& face : mesh.faces) {
    const Vector3 &a = mesh.vertices[face[0]], &b = mesh.vertices[face[1]], &c = mesh.vertices[face[2]];
    const Vector3 normal = (b - a).cross(c - a).normalized();
    gradient[face[0]] += 0.5 * normal.cross(c - b);
    gradient[face[1]] += 0.5 * normal.cross(a - c);
    gradient[face[2]] += 0.5 * normal.cross(b - a);
  }
  double sum = 0;
  for (const Vector3& g : gradient) sum += g.squaredNorm();
  return sum * double(mesh.vertices.size()) / std::pow(mesh_area(mesh), 2);
}

double mean_edge(const Mesh& mesh) {
  double sum = 0;
  const auto edges = mesh_edges(mesh);
  for (const MeshEdge& edge : edges) sum += (mesh.vertices[edge.p] - mesh.vertices[edge.q]).norm();
  return sum / double(edges.size());
}

double volume_response(const CellTypeLattice& cell, double modulus) { return modulus * cell.area / (2 * speed_of_sound * cell.volume); }
double area_response(const CellTypeLattice& cell, double modulus) { return modulus * cell.squared_curvature / (2 * speed_of_sound); }
double volume_modulus(const CellTypeLattice& cell, double response) { return response / volume_response(cell, 1); }
double area_modulus(const CellTypeLattice& cell, double response) { return response / area_response(cell, 1); }

}  // namespace corpuscle
