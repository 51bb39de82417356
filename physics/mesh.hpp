// A closed triangulated surface on the host, and the reference shapes of docs/theory/model.md, "Membrane".
#pragma once
#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "physics/problem.hpp"

namespace corpuscle {

using Vector3 = Eigen::Vector3d;

/// Closed, consistently oriented (outward) triangulation. Lengths are the caller's (lattice units once scaled).
struct Mesh {
  std::vector<Vector3> vertices;
  std::vector<std::array<int, 3>> faces;
};

/// Geodesic icosahedron of frequency n on the unit sphere: 20 n^2 faces, 10 n^2 + 2 vertices, in an order that keeps neighbours close in memory.
Mesh icosphere(int frequency);
/// Red cell of large radius r (docs/theory/model.md, reference shape; every vertex of the unit sphere keeps x, y and z is replaced).
Mesh red_cell_mesh(double radius, int frequency);
Mesh sphere_mesh(double radius, int frequency);
/// Spheroid with equatorial radius and semi-axis along z = aspect_ratio * radius; the larger of the two semi-axes is `radius`.
Mesh spheroid_mesh(double radius, double aspect_ratio, int frequency);
/// Reads an OFF file; scales it so that the largest distance of a vertex from the centroid is `radius`, centroid at the origin.
/// @throws InputError when the file is missing, malformed, open, non-manifold, badly oriented (fixed when globally inverted), degenerate or not of genus 0.
Mesh read_off(const std::string& path, double radius);
/// The mesh of a scene's cell type. `radius` in lattice units already includes relative_radius.
Mesh make_mesh(const CellSpec& spec, double radius, int frequency);

/// An edge p -> q of a closed mesh and the tips of its two triangles: `left` of it and `right` of it, seen from outside.
struct MeshEdge {
  int p, q, left, right;
};
/// Every edge once, p < q. @throws InputError when the mesh is open or not consistently oriented.
std::vector<MeshEdge> mesh_edges(const Mesh& mesh);
/// Angle between the normals of the triangles (p, q, left) and (q, p, right); positive where the surface is convex.
double edge_angle(const Vector3& p, const Vector3& q, const Vector3& left, const Vector3& right);

double mesh_volume(const Mesh& mesh);
double mesh_area(const Mesh& mesh);
/// Volume with a shell of thickness h outside (Steiner formula with the discrete mean curvature, H = 1/2 sum_edges length * angle / ... ).
double mesh_effective_volume(const Mesh& mesh, double shell_thickness);
Vector3 mesh_centroid(const Mesh& mesh);  ///< of the enclosed volume

/// Neighbourhood of every vertex, shared by all cells of a type. Row v has `degree[v]` valid entries.
struct OneRing {
  int vertex_count = 0;
  int max_degree = 0;
  std::vector<int> degree;      ///< [V]
  std::vector<int> neighbour;   ///< [V][max_degree] in counter-clockwise order seen from outside: faces are (v, n_i, n_{i+1})
};
OneRing one_ring(const Mesh& mesh);

}  // namespace corpuscle
