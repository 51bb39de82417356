// Measures, topology and one-ring tables of the reference shapes, against docs/theory/model.md and closed formulas.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "core/error.hpp"
#include "physics/mesh.hpp"
#include "tests/catch.hpp"
#include "tests/complaint.hpp"

using namespace corpuscle;
using std::numbers::pi;

namespace {

constexpr double red_cell_volume = 1.57145, red_cell_area = 8.7639;  // of the continuum shape, r = 1

/// Every directed edge once and its reverse too: closed and consistently oriented.
bool is_closed_and_oriented(const Mesh& mesh) {
  std::set<std::pair<int, int>> edges;
  for (const auto& f : mesh.faces)
    for (int c = 0; c < 3; ++c)
      if (!edges.insert({f[c], f[(c + 1) % 3]}).second) return false;
  return std::all_of(edges.begin(), edges.end(), [&](const auto& e) { return edges.count({e.second, e.first}) == 1; });
}

double mean_index_distance(const Mesh& mesh) {
  double sum = 0;
  for (const auto& f : mesh.faces)
    for (int c = 0; c < 3; ++c) sum += std::abs(f[c] - f[(c + 1) % 3]);
  return sum / (3.0 * static_cast<double>(mesh.faces.size()));
}

}  // namespace

TEST_CASE("icosphere: counts, topology, unit radius, memory order", "[mesh]") {
  const int n = GENERATE(1, 2, 3, 5, 8, 9, 12);
  const Mesh mesh = icosphere(n);
  REQUIRE(mesh.vertices.size() == static_cast<std::size_t>(10 * n * n + 2));
  REQUIRE(mesh.faces.size() == static_cast<std::size_t>(20 * n * n));
  CHECK(is_closed_and_oriented(mesh));
  for (const Vector3& x : mesh.vertices) CHECK(x.norm() == Approx(1).epsilon(1e-14));
  for (const auto& f : mesh.faces) {  // outward
    const Vector3 normal = (mesh.vertices[f[1]] - mesh.vertices[f[0]]).cross(mesh.vertices[f[2]] - mesh.vertices[f[0]]);
    CHECK(normal.dot(mesh.vertices[f[0]]) > 0);
  }
  CHECK(mean_index_distance(mesh) < 3.3 * n);  // a random order would give V/3 = 3.3 n^2
}

TEST_CASE("icosphere refuses senseless subdivisions", "[mesh]") {
  CHECK_THROWS_AS(icosphere(0), InputError);
  CHECK_THROWS_AS(icosphere(-3), InputError);
  CHECK_THROWS_AS(icosphere(100000), InputError);
  CHECK_THROWS_AS(red_cell_mesh(-1, 6), InputError);
  CHECK_THROWS_AS(sphere_mesh(std::nan(""), 6), InputError);
  CHECK_THROWS_AS(spheroid_mesh(1, 0, 6), InputError);
}

TEST_CASE("red cell: volume and area of the discrete shape", "[mesh]") {
  struct Row {
    int n;
    double volume, area;
  };
  const auto [n, volume, area] = GENERATE(Row{6, 1.5477, 8.6659}, Row{8, 1.5580, 8.7084}, Row{9, 1.5608, 8.7200}, Row{12, 1.5655, 8.7391});
  const double r = 7.5;
  const Mesh mesh = red_cell_mesh(r, n);
  CHECK(mesh_volume(mesh) / (r * r * r) == Approx(volume).epsilon(5e-5));
  CHECK(mesh_area(mesh) / (r * r) == Approx(area).epsilon(5e-5));
  CHECK(mesh_centroid(mesh).norm() < 1e-12 * r);
}

TEST_CASE("red cell: second-order convergence to the continuum", "[mesh]") {
  const Mesh coarse = red_cell_mesh(1, 16), fine = red_cell_mesh(1, 32);
  CHECK((red_cell_volume - mesh_volume(coarse)) / (red_cell_volume - mesh_volume(fine)) == Approx(4).epsilon(0.05));
  CHECK((red_cell_area - mesh_area(coarse)) / (red_cell_area - mesh_area(fine)) == Approx(4).epsilon(0.05));
  // Richardson: what is left after the second order.
  CHECK((4 * mesh_volume(fine) - mesh_volume(coarse)) / 3 == Approx(red_cell_volume).epsilon(1e-5));
  CHECK((4 * mesh_area(fine) - mesh_area(coarse)) / 3 == Approx(red_cell_area).epsilon(1e-5));
}

TEST_CASE("red cell: thickness and large radius", "[mesh]") {
  const double r = 9;
  const Mesh mesh = red_cell_mesh(r, 48);
  double half_thickness = 0, radius = 0, centre = r;
  for (const Vector3& x : mesh.vertices) {
    const double rho = std::hypot(x.x(), x.y());
    half_thickness = std::max(half_thickness, x.z());
    radius = std::max(radius, rho);
    if (rho < 0.02 * r) centre = std::min(centre, std::abs(x.z()));
  }
  CHECK(half_thickness / r == Approx(0.3276).epsilon(1e-3));
  CHECK(centre / r == Approx(0.1035).epsilon(1e-2));
  CHECK(radius == Approx(r).epsilon(1e-3));
  CHECK(radius <= r * (1 + 1e-14));
}

TEST_CASE("sphere and spheroids: volume, area, semi-axes", "[mesh]") {
  const Mesh sphere = sphere_mesh(2, 40);
  CHECK(mesh_volume(sphere) == Approx(4 * pi / 3 * 8).epsilon(2e-3));
  CHECK(mesh_area(sphere) == Approx(4 * pi * 4).epsilon(2e-3));
  const double aspect = GENERATE(0.25, 0.5, 1.0, 2.0, 4.0);
  const Mesh mesh = spheroid_mesh(3, aspect, 40);
  const double equatorial = std::min(3.0, 3.0 / aspect), polar = equatorial * aspect;
  CHECK(mesh_volume(mesh) == Approx(4 * pi / 3 * equatorial * equatorial * polar).epsilon(2e-3));
  double farthest = 0;
  for (const Vector3& x : mesh.vertices) farthest = std::max(farthest, x.norm());
  CHECK(farthest == Approx(3).epsilon(2e-3));
}

TEST_CASE("effective volume: Steiner formula", "[mesh]") {
  SECTION("cube of edge 1: 1 + 6 h + 3 pi h^2 + 4/3 pi h^3, exactly") {
    Mesh cube;
    for (int i = 0; i < 8; ++i) cube.vertices.emplace_back(i & 1, (i >> 1) & 1, i >> 2);
    cube.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    const double h = 0.3;
    CHECK(mesh_effective_volume(cube, h) == Approx(1 + 6 * h + 3 * pi * h * h + 4 * pi / 3 * h * h * h));
    CHECK(mesh_centroid(cube).isApprox(Vector3(0.5, 0.5, 0.5)));
  }
  SECTION("sphere") {
    const Mesh sphere = sphere_mesh(9, 30);
    CHECK(mesh_effective_volume(sphere, 0.3) == Approx(4 * pi / 3 * std::pow(9.3, 3)).epsilon(1e-3));
    CHECK(mesh_effective_volume(sphere, 0) == Approx(mesh_volume(sphere)));
  }
  SECTION("red cell of the paper: about 1366 at r = 9, h = 0.3") {
    CHECK(mesh_effective_volume(red_cell_mesh(9, 9), 0.3) == Approx(1366).epsilon(0.015));
    CHECK(mesh_effective_volume(red_cell_mesh(9, 9), 0.3) == Approx(1358.5).epsilon(1e-4));
    CHECK(mesh_effective_volume(red_cell_mesh(9, 60), 0.3) == Approx(1366).epsilon(2e-3));
  }
}

TEST_CASE("measures do not depend on where the mesh is", "[mesh]") {
  Mesh mesh = red_cell_mesh(9, 6);
  const double volume = mesh_volume(mesh), effective = mesh_effective_volume(mesh, 0.3);
  const Vector3 shift(1e4, -2e4, 3e4);
  for (Vector3& x : mesh.vertices) x += shift;
  CHECK(mesh_volume(mesh) == Approx(volume).epsilon(1e-10));
  CHECK(mesh_effective_volume(mesh, 0.3) == Approx(effective).epsilon(1e-9));
  CHECK((mesh_centroid(mesh) - shift).norm() < 1e-7);
}

TEST_CASE("one_ring: cyclic, counter-clockwise, opposite vertices", "[mesh]") {
  const int n = GENERATE(1, 2, 4, 9);
  const Mesh mesh = red_cell_mesh(1, n);
  const OneRing ring = one_ring(mesh);
  REQUIRE(ring.vertex_count == 10 * n * n + 2);
  REQUIRE(ring.max_degree == (n == 1 ? 5 : 6));
  REQUIRE(ring.neighbour.size() == static_cast<std::size_t>(ring.vertex_count * ring.max_degree));

  std::map<std::pair<int, int>, int> corner;  // of every directed edge
  for (const auto& f : mesh.faces)
    for (int c = 0; c < 3; ++c) corner[{f[c], f[(c + 1) % 3]}] = f[(c + 2) % 3];

  int of_degree_5 = 0;
  bool consistent = true;
  for (int v = 0; v < ring.vertex_count; ++v) {
    const int degree = ring.degree[v];
    of_degree_5 += degree == 5;
    consistent &= degree == 5 || degree == 6;
    const int* neighbour = &ring.neighbour[v * ring.max_degree];
    for (int i = 0; i < degree; ++i) {
      const int next = neighbour[(i + 1) % degree];
      consistent &= corner.at({v, neighbour[i]}) == next;           // (v, n_i, n_i+1) is a face
    }
    consistent &= *std::min_element(neighbour, neighbour + degree) == neighbour[0];
    for (int i = degree; i < ring.max_degree; ++i) consistent &= neighbour[i] == v;
  }
  CHECK(consistent);
  CHECK(of_degree_5 == 12);
}

TEST_CASE("one_ring refuses surfaces that are not closed or not manifold", "[mesh]") {
  Mesh open = icosphere(2);
  open.faces.pop_back();
  CHECK_THROWS_AS(one_ring(open), InputError);

  Mesh pinched;  // two tetrahedra that share vertex 0
  pinched.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  pinched.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}};
  CHECK(complaint_lacks([&] { one_ring(pinched); }, {"single fan"}) == "");
}

TEST_CASE("make_mesh dispatches on the shape", "[mesh]") {
  CellSpec spec;
  CHECK(mesh_volume(make_mesh(spec, 2, 5)) == Approx(mesh_volume(red_cell_mesh(2, 5))));
  spec.shape = ShapeKind::sphere;
  CHECK(mesh_volume(make_mesh(spec, 2, 5)) == Approx(mesh_volume(sphere_mesh(2, 5))));
  spec.shape = ShapeKind::spheroid;
  spec.aspect_ratio = 0.3;
  CHECK(mesh_volume(make_mesh(spec, 2, 5)) == Approx(mesh_volume(spheroid_mesh(2, 0.3, 5))));
  spec.shape = ShapeKind::file;
  spec.file = "no-such-file.off";
  CHECK_THROWS_AS(make_mesh(spec, 2, 5), InputError);
}
