// Reference shapes of docs/theory/model.md, "Membrane": all are images of one geodesic icosahedron, so they share their connectivity.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "core/error.hpp"
#include "physics/mesh.hpp"

namespace corpuscle {
namespace {

/// Regular icosahedron with a two-fold axis along each coordinate axis, faces counter-clockwise seen from outside.
Mesh icosahedron() {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  Mesh mesh;
  mesh.vertices = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0}, {0, -1, g}, {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  mesh.faces = {{0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                {3, 9, 4}, {3, 4, 2}, {3, 2, 6}, {3, 6, 8}, {3, 8, 9}, {4, 9, 5}, {2, 4, 11}, {6, 2, 10}, {8, 6, 7}, {9, 8, 1}};
  return mesh;
}

/// Cuthill-McKee: breadth-first from a vertex of lowest degree, neighbours in order of degree. The numbering is a spiral of rings around
/// that vertex. It uses the connectivity only, no coordinates, so it is the same on any machine.
/// Mean |i - j| over the edges at n = 9: 26, at most 46 (by latitude 27, face by face 47, Hilbert curve 37; their largest is 83 to 750).
std::vector<int> cuthill_mckee(int vertex_count, const std::vector<std::array<int, 3>>& faces) {
  std::vector<std::vector<int>> neighbours(vertex_count);
  for (const auto& face : faces)
    for (int corner = 0; corner < 3; ++corner) neighbours[face[corner]].push_back(face[(corner + 1) % 3]);  // each edge once per direction
  const auto by_degree = [&](int a, int b) { return std::pair(neighbours[a].size(), a) < std::pair(neighbours[b].size(), b); };
  for (auto& row : neighbours) std::sort(row.begin(), row.end(), by_degree);

  std::vector<int> all(vertex_count);
  std::iota(all.begin(), all.end(), 0);
  std::vector<int> order{*std::min_element(all.begin(), all.end(), by_degree)};
  std::vector<char> seen(vertex_count, 0);
  seen[order.front()] = 1;
  for (std::size_t next = 0; next < order.size(); ++next)
    for (const int neighbour : neighbours[order[next]])
      if (!seen[neighbour]) {
        seen[neighbour] = 1;
        order.push_back(neighbour);
      }
  return order;
}

/// Renumbers the vertices in the given order, and the faces by their smallest vertex so that they are near in memory as well.
Mesh reorder(const Mesh& mesh, const std::vector<int>& order) {
  std::vector<int> rank(order.size());
  Mesh result;
  for (std::size_t i = 0; i < order.size(); ++i) {
    rank[order[i]] = static_cast<int>(i);
    result.vertices.push_back(mesh.vertices[order[i]]);
  }
  for (const auto& face : mesh.faces) {
    std::array<int, 3> renumbered{rank[face[0]], rank[face[1]], rank[face[2]]};
    std::rotate(renumbered.begin(), std::min_element(renumbered.begin(), renumbered.end()), renumbered.end());
    result.faces.push_back(renumbered);
  }
  std::sort(result.faces.begin(), result.faces.end());
  return result;
}

/// Divides every edge into `frequency` parts and every face into frequency^2 triangles, and projects onto the unit sphere.
Mesh subdivide(const Mesh& coarse, int frequency) {
  Mesh fine;
  // A point is known by the corners it depends on and their integer weights: points of shared corners and edges get one key.
  std::map<std::array<std::array<int, 2>, 3>, int> known;
  const auto point = [&](const std::array<int, 3>& corners, const std::array<int, 3>& weights) {
    std::array<std::array<int, 2>, 3> key;
    for (int c = 0; c < 3; ++c) key[c] = weights[c] > 0 ? std::array<int, 2>{corners[c], weights[c]} : std::array<int, 2>{-1, 0};
    std::sort(key.begin(), key.end());
    const auto [entry, is_new] = known.try_emplace(key, static_cast<int>(fine.vertices.size()));
    if (is_new) {
      Vector3 position = Vector3::Zero();
      for (const auto& [corner, weight] : key)
        if (weight > 0) position += weight * coarse.vertices[corner];
      fine.vertices.push_back(position.normalized());
    }
    return entry->second;
  };
  for (const auto& face : coarse.faces)
    for (int i = 0; i < frequency; ++i)
      for (int j = 0; i + j < frequency; ++j) {
        const int k = frequency - i - j;
        const int a = point(face, {k, i, j}), b = point(face, {k - 1, i + 1, j}), c = point(face, {k - 1, i, j + 1});
        fine.faces.push_back({a, b, c});
        if (k >= 2) fine.faces.push_back({b, point(face, {k - 2, i + 1, j + 1}), c});
      }
  return fine;
}

/// The unit sphere with every vertex moved by `map`.
template <class Map>
Mesh mapped_sphere(int frequency, const Map& map) {
  Mesh mesh = icosphere(frequency);
  for (Vector3& x : mesh.vertices) x = map(x);
  return mesh;
}

void require_positive(double value, const char* name) {
  if (!(std::isfinite(value) && value > 0))
    throw InputError(std::string(name) + " of a cell is " + std::to_string(value) + ", but must be a positive number; correct it in [[cells]].");
}

}  // namespace

Mesh icosphere(int frequency) {
  constexpr int largest = 1000;  // 10 million vertices per cell: certainly a mistake, and indices must stay within int
  if (frequency < 1 || frequency > largest)
    throw InputError("The subdivision of a cell is " + std::to_string(frequency) + ", but must lie between 1 and " + std::to_string(largest) +
                     "; set accuracy.subdivision near the radius in lattice units.");
  const Mesh mesh = subdivide(icosahedron(), frequency);
  return reorder(mesh, cuthill_mckee(static_cast<int>(mesh.vertices.size()), mesh.faces));
}

Mesh red_cell_mesh(double radius, int frequency) {
  require_positive(radius, "The radius");
  return mapped_sphere(frequency, [radius](const Vector3& x) -> Vector3 {
    // On the unit sphere z = +- sqrt(1 - rho^2): the square root of the profile needs no evaluation, and the equator is exact.
    const double rho2 = x.x() * x.x() + x.y() * x.y();
    const double profile = 0.5 * (0.207 + rho2 * (2.000 - 1.123 * rho2));
    return radius * Vector3(x.x(), x.y(), profile * x.z());
  });
}

Mesh sphere_mesh(double radius, int frequency) {
  require_positive(radius, "The radius");
  return mapped_sphere(frequency, [radius](const Vector3& x) -> Vector3 { return radius * x; });
}

Mesh spheroid_mesh(double radius, double aspect_ratio, int frequency) {
  require_positive(radius, "The radius");
  require_positive(aspect_ratio, "The aspect_ratio");
  const double equatorial = aspect_ratio <= 1 ? radius : radius / aspect_ratio;
  const double polar = aspect_ratio <= 1 ? radius * aspect_ratio : radius;
  return mapped_sphere(frequency,
                       [=](const Vector3& x) -> Vector3 { return {equatorial * x.x(), equatorial * x.y(), polar * x.z()}; });
}

Mesh make_mesh(const CellSpec& spec, double radius, int frequency) {
  switch (spec.shape) {
    case ShapeKind::red_cell: return red_cell_mesh(radius, frequency);
    case ShapeKind::sphere: return sphere_mesh(radius, frequency);
    case ShapeKind::spheroid: return spheroid_mesh(radius, spec.aspect_ratio, frequency);
    case ShapeKind::file: return read_off(spec.file, radius);
  }
  throw InputError("The cell type '" + spec.name + "' has an unknown shape; choose red_cell, sphere, spheroid or a mesh file.");
}

}  // namespace corpuscle
