#include "physics/mesh_check.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/error.hpp"

namespace corpuscle {
namespace {

using std::to_string;
using Edge = std::pair<int, int>;

/// Longest edge over the height on it: a triangle flatter than this has no usable normal.
constexpr double flattest = 1e4;

std::string name(const Edge& edge) { return "the edge between vertices " + to_string(edge.first) + " and " + to_string(edge.second); }

void require_valid_faces(const Mesh& mesh, const std::string& source) {
  const int vertex_count = static_cast<int>(mesh.vertices.size());
  std::vector<char> used(mesh.vertices.size(), 0);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto& face = mesh.faces[f];
    for (const int v : face) {
      if (v < 0 || v >= vertex_count)
        throw InputError(source + ": face " + to_string(f) + " names vertex " + to_string(v) + ", but vertices are counted from 0 to " +
                         to_string(vertex_count - 1) + "; correct the index.");
      used[v] = 1;
    }
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0])
      throw InputError(source + ": face " + to_string(f) + " names a vertex twice, but its three corners must differ; remove the face.");
  }
  const auto unused = std::find(used.begin(), used.end(), 0);
  if (unused != used.end())
    throw InputError(source + ": vertex " + to_string(unused - used.begin()) + " belongs to no face, but every vertex must; remove unused vertices.");
}

/// Every edge must belong to two faces that pass it in opposite directions.
void require_matched_edges(const Mesh& mesh, const std::string& source) {
  struct Use {
    int forward = 0, backward = 0;
    std::size_t face = 0;  // the last one
  };
  std::map<Edge, Use> uses;  // ordered: the first complaint is the same everywhere
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (int c = 0; c < 3; ++c) {
      const int a = mesh.faces[f][c], b = mesh.faces[f][(c + 1) % 3];
      Use& use = uses[{std::min(a, b), std::max(a, b)}];
      ++(a < b ? use.forward : use.backward);
      use.face = f;
    }
  for (const auto& [edge, use] : uses) {
    const int faces = use.forward + use.backward;
    if (faces == 1)
      throw InputError(source + ": the surface is open at " + name(edge) + " of face " + to_string(use.face) +
                       ", but it must be closed; fill the hole, or merge coinciding vertices.");
    if (faces > 2)
      throw InputError(source + ": " + name(edge) + " belongs to " + to_string(faces) + " faces (the last is face " + to_string(use.face) +
                       "), but every edge must belong to exactly two; remove inner or doubled faces.");
  }
  for (const auto& [edge, use] : uses)
    if (use.forward != 1)
      throw InputError(source + ": the two faces at " + name(edge) + " (one is face " + to_string(use.face) +
                       ") are oriented against each other, but all must be counter-clockwise seen from outside; make the orientation consistent.");
}

/// The faces around every vertex must form one fan, of at most largest_degree faces.
void require_single_fans(const Mesh& mesh, const std::string& source) {
  std::vector<std::vector<Edge>> fans(mesh.vertices.size());  // (next, after next) of each face around the vertex
  for (const auto& face : mesh.faces)
    for (int c = 0; c < 3; ++c) fans[face[c]].emplace_back(face[(c + 1) % 3], face[(c + 2) % 3]);
  for (std::size_t v = 0; v < fans.size(); ++v) {
    const int degree = static_cast<int>(fans[v].size());
    if (degree > largest_degree)
      throw InputError(source + ": vertex " + to_string(v) + " has " + to_string(degree) + " neighbours, but at most " + to_string(largest_degree) +
                       " are possible; remesh the surface with triangles of similar size.");
    int corner = fans[v].front().second, steps = 1;
    for (; corner != fans[v].front().first; ++steps)  // edges are matched: the walk returns to its start
      corner = std::find_if(fans[v].begin(), fans[v].end(), [&](const Edge& e) { return e.first == corner; })->second;
    if (steps != degree)
      throw InputError(source + ": two sheets of the surface touch in vertex " + to_string(v) +
                       ", but the faces around a vertex must form one fan; split that vertex.");
  }
}

void require_one_sphere(const Mesh& mesh, const std::string& source) {
  std::vector<int> parent(mesh.vertices.size());
  for (std::size_t v = 0; v < parent.size(); ++v) parent[v] = static_cast<int>(v);
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  int components = static_cast<int>(mesh.vertices.size());
  for (const auto& face : mesh.faces)
    for (int c = 1; c < 3; ++c) {
      const int a = root(face[0]), b = root(face[c]);
      if (a != b) parent[a] = b, --components;
    }
  if (components != 1)
    throw InputError(source + ": the surface has " + to_string(components) +
                     " separate parts, but a cell is one closed surface; keep one part per file.");
  const long long genus = (2 - static_cast<long long>(mesh.vertices.size()) + static_cast<long long>(mesh.faces.size() / 2)) / 2;  // 2 E = 3 F
  if (genus != 0)
    throw InputError(source + ": the surface has " + to_string(genus) + (genus == 1 ? " handle" : " handles") +
                     ", but a cell must have the topology of a sphere; close its holes.");
}

/// Every triangle must be thick enough to have a normal.
void require_solid_triangles(const Mesh& mesh, const std::string& source) {
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto& face = mesh.faces[f];
    const Vector3 ab = mesh.vertices[face[1]] - mesh.vertices[face[0]], ac = mesh.vertices[face[2]] - mesh.vertices[face[0]];
    const double longest2 = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
    if (!(ab.cross(ac).norm() * flattest > longest2))  // area = 1/2 edge * height
      throw InputError(source + ": face " + to_string(f) + " (vertices " + to_string(face[0]) + ", " + to_string(face[1]) + ", " +
                       to_string(face[2]) + ") is degenerate, but every triangle must have an area; merge its coinciding vertices or remesh.");
  }
}

}  // namespace

void require_cell_surface(Mesh& mesh, const std::string& source) {
  if (mesh.faces.size() < 4)
    throw InputError(source + ": the surface has " + to_string(mesh.faces.size()) +
                     " faces, but a closed one has at least 4; check that the file is complete.");
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (!mesh.vertices[v].allFinite())
      throw InputError(source + ": vertex " + to_string(v) + " has a coordinate that is not a finite number; correct it.");
  require_valid_faces(mesh, source);
  require_matched_edges(mesh, source);
  require_single_fans(mesh, source);
  require_one_sphere(mesh, source);
  require_solid_triangles(mesh, source);

  const double volume = mesh_volume(mesh), area = mesh_area(mesh);
  // Reduced volume 6 sqrt(pi) V / A^1.5 of a sphere is 1, of a red cell 0.64.
  if (!(std::abs(volume) > 1e-4 * std::pow(area, 1.5)))
    throw InputError(source + ": the surface encloses almost no volume (" + to_string(volume) + " for an area of " + to_string(area) +
                     "), but a cell must have an inside; check for self-intersections.");
  if (volume < 0)  // inside out as a whole
    for (auto& face : mesh.faces) std::swap(face[1], face[2]);
}

}  // namespace corpuscle
