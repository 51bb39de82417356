// Overlap of cells: analytic arrangements, periodic images, and a check against the winding number.
#include "physics/overlap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/random.hpp"
#include "physics/overlap_inside.hpp"
#include "physics/placement.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

namespace {

/// Owns what a CellGeometry views.
struct Arrangement {
  std::array<double, 3> box{40, 40, 40};
  bool walls = true;
  std::vector<Mesh> meshes;
  std::vector<std::vector<double>> positions;

  void add(const Mesh& mesh, const Vector3& centre, const UnitQuaternion& q = {1, 0, 0, 0}) {
    meshes.push_back(mesh);
    positions.push_back(place_mesh(mesh, centre, q));
  }
  CellView cell(std::size_t c) const { return {positions[c].data(), static_cast<int>(meshes[c].vertices.size()), &meshes[c].faces}; }
  Vector3 vertex(std::size_t c, std::size_t v) const { return Eigen::Map<const Vector3>(positions[c].data() + 3 * v); }
  OverlapReport check() const {
    CellGeometry geometry{box, walls, {}};
    for (std::size_t c = 0; c < meshes.size(); ++c) geometry.cells.push_back(cell(c));
    return check_overlap(geometry);
  }
};

/// The slow truth: all vertices against all cells and images up to two periods away, by the winding number and all pairs of vertices.
OverlapReport brute_force(const Arrangement& a) {
  OverlapReport report;
  std::vector<Vector3> lower, upper;  // only to skip what is certainly far away
  for (std::size_t c = 0; c < a.meshes.size(); ++c) {
    lower.push_back(a.vertex(c, 0));
    upper.push_back(a.vertex(c, 0));
    for (std::size_t v = 0; v < a.meshes[c].vertices.size(); ++v) {
      lower[c] = lower[c].cwiseMin(a.vertex(c, v));
      upper[c] = upper[c].cwiseMax(a.vertex(c, v));
    }
  }
  const int periods_z = a.walls ? 0 : 2;
  for (std::size_t c = 0; c < a.meshes.size(); ++c)
    for (std::size_t v = 0; v < a.meshes[c].vertices.size(); ++v) {
      bool inside = false;
      for (int k = -periods_z; k <= periods_z; ++k)
        for (int j = -2; j <= 2; ++j)
          for (int i = -2; i <= 2; ++i)
            for (std::size_t d = 0; d < a.meshes.size(); ++d) {
              if (c == d && i == 0 && j == 0 && k == 0) continue;
              const Vector3 x = a.vertex(c, v) + Vector3(i * a.box[0], j * a.box[1], k * a.box[2]);
              const double away = (x - x.cwiseMax(lower[d]).cwiseMin(upper[d])).norm();  // from the bounding box
              if (away == 0) inside = inside || winding_number(a.cell(d), x) > 0.5;
              for (std::size_t w = 0; w < a.meshes[d].vertices.size() && away < report.smallest_gap; ++w)
                report.smallest_gap = std::min(report.smallest_gap, (x - a.vertex(d, w)).norm());
            }
      report.vertices_inside += inside;
    }
  return report;
}

}  // namespace

TEST_CASE("overlap: two spheres apart, nearly touching, overlapping", "[overlap]") {
  Arrangement a;
  const Mesh sphere = sphere_mesh(4, 6);
  double right = 0;  // extents of the mesh along x
  for (const Vector3& x : sphere.vertices) right = std::max(right, x.x());
  a.add(sphere, Vector3(12, 20, 20));
  SECTION("apart") {
    a.add(sphere, Vector3(22, 20, 20));
    const OverlapReport report = a.check();
    CHECK(report.is_clean());
    CHECK(report.first_cell == -1);
    CHECK(report.smallest_gap == Approx(10 - 2 * right));
  }
  SECTION("nearly touching") {
    a.add(sphere, Vector3(12 + 2 * right + 1e-9, 20, 20));
    CHECK(a.check().vertices_inside == 0);
    CHECK(a.check().smallest_gap == Approx(1e-9).epsilon(1e-3));
  }
  SECTION("overlapping") {
    a.add(sphere, Vector3(16.03, 20, 20));  // no vertex on the other's surface, where rounding decides
    const OverlapReport report = a.check(), expected = brute_force(a);
    CHECK(report.vertices_inside == expected.vertices_inside);
    CHECK(report.vertices_inside > 50);
    CHECK(report.smallest_gap == Approx(expected.smallest_gap));
    CHECK((report.first_cell == 1 && report.second_cell == 0));
    CHECK(!report.is_clean());
  }
}

TEST_CASE("overlap: a cell inside another", "[overlap]") {
  Arrangement a;
  a.add(sphere_mesh(8, 6), Vector3(20, 20, 20));
  a.add(sphere_mesh(2, 4), Vector3(21, 20, 19));
  CHECK(a.check().vertices_inside == 162);  // all of the inner one
  CHECK((a.check().first_cell == 1 && a.check().second_cell == 0));
}

TEST_CASE("overlap: points exactly over edges and vertices", "[overlap]") {
  // A stack with equal x and y: every vertical ray passes through a vertex of the other cell.
  Arrangement a;
  const Mesh sphere = sphere_mesh(4, 8);
  a.add(sphere, Vector3(20, 20, 16));
  a.add(sphere, Vector3(20, 20, 20.03));
  CHECK(a.check().vertices_inside == brute_force(a).vertices_inside);
  a.add(sphere, Vector3(20, 20, 30));
  CHECK(a.check().vertices_inside == brute_force(a).vertices_inside);

  // A cube, whose vertical faces vanish in projection; points on all special positions.
  Mesh cube;
  for (int i = 0; i < 8; ++i) cube.vertices.emplace_back(i & 1, (i >> 1) & 1, i >> 2);
  cube.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  const std::vector<double> x = place_mesh(cube, Vector3::Zero(), {1, 0, 0, 0});
  InsideTest test;
  test.reset({x.data(), 8, &cube.faces});
  for (int i = -1; i <= 5; ++i)
    for (int j = -1; j <= 5; ++j)
      for (int k = -1; k <= 5; ++k) {
        const bool strictly_inside = i > 0 && i < 4 && j > 0 && j < 4 && k > 0 && k < 4;
        const bool outside = i < 0 || i > 4 || j < 0 || j > 4 || k < 0 || k > 4;
        const bool found = test.contains(Vector3(i / 4.0, j / 4.0, k / 4.0));
        if (strictly_inside) CHECK(found);
        if (outside) CHECK(!found);
        if (k == 0 || k == 4) CHECK(!found);  // on the bottom or the top
      }
}

TEST_CASE("overlap: inside test agrees with the winding number at random points", "[overlap]") {
  RandomStream random(5);
  for (int trial = 0; trial < 5; ++trial) {
    const Mesh mesh = red_cell_mesh(4, 6);
    const std::vector<double> x = place_mesh(mesh, Vector3::Zero(), random_rotation(random));
    const CellView cell{x.data(), static_cast<int>(mesh.vertices.size()), &mesh.faces};
    InsideTest test;
    test.reset(cell);
    int inside = 0, wrong = 0;
    const int points = 4000;
    for (int i = 0; i < points; ++i) {
      const double px = random.uniform(-4, 4), py = random.uniform(-4, 4);
      const Vector3 p(px, py, random.uniform(-4, 4));
      const bool found = test.contains(p);
      inside += found;
      wrong += found != (winding_number(cell, p) > 0.5);
    }
    CHECK(wrong == 0);
    CHECK(512.0 * inside / points == Approx(mesh_volume(mesh)).epsilon(0.15));
  }
}

TEST_CASE("overlap: across periodic boundaries, with unwrapped positions", "[overlap]") {
  const Mesh sphere = sphere_mesh(4, 6);
  Arrangement a;
  a.add(sphere, Vector3(1, 20, 20));
  a.add(sphere, Vector3(40 - 1 + 40 * 7, 20 - 40 * 3, 20));  // drifted: seven and three periods away
  CHECK(a.check().vertices_inside > 50);
  Arrangement b;
  b.add(sphere, Vector3(18, 20, 20));
  b.add(sphere, Vector3(20, 20, 20));
  CHECK(a.check().vertices_inside == b.check().vertices_inside);
  CHECK(a.check().smallest_gap == Approx(b.check().smallest_gap));

  Arrangement in_z;
  in_z.add(sphere, Vector3(20, 20, 1));
  in_z.add(sphere, Vector3(20, 20, 39));
  CHECK(in_z.check().vertices_inside == 0);
  CHECK(in_z.check().vertices_outside_walls > 100);
  in_z.walls = false;
  CHECK(in_z.check().vertices_inside == brute_force(in_z).vertices_inside);
  CHECK(in_z.check().vertices_inside > 50);
  CHECK(in_z.check().vertices_outside_walls == 0);
}

TEST_CASE("overlap: a cell and its own images", "[overlap]") {
  const Mesh sphere = sphere_mesh(4, 6);
  Arrangement a;
  a.add(sphere, Vector3(3, 50, 5));
  a.box = {7.5, 9, 10};
  const OverlapReport report = a.check(), expected = brute_force(a);
  CHECK(report.vertices_inside == expected.vertices_inside);
  CHECK(report.vertices_inside > 0);
  CHECK((report.first_cell == 0 && report.second_cell == 0));
  CHECK(report.smallest_gap == Approx(expected.smallest_gap));
  a.box = {8.5, 9, 10};
  CHECK(a.check().is_clean());
  CHECK(a.check().smallest_gap == Approx(brute_force(a).smallest_gap));
  a.box = {2.5, 3, 10};  // the cell spans several periods
  CHECK(a.check().vertices_inside == brute_force(a).vertices_inside);
}

TEST_CASE("overlap: rouleaux and dimples", "[overlap]") {
  const Mesh cell = red_cell_mesh(9, 9);
  Arrangement stack;
  SECTION("tilted stack: bounding boxes overlap strongly, shapes don't") {
    const UnitQuaternion q = rotation_to_axis({1, 1, 1});
    const Vector3 step = Vector3(1, 1, 1).normalized() * (2 * 0.3276 * 9 + 0.1);
    for (int i = -1; i <= 1; ++i) stack.add(cell, Vector3(20, 20, 20) + i * step, q);
    CHECK(stack.check().is_clean());
    CHECK(stack.check().smallest_gap == Approx(brute_force(stack).smallest_gap));
    CHECK(stack.check().smallest_gap < 0.2);
    stack.add(cell, Vector3(20, 20, 20) + 0.2 * step, q);
    CHECK(stack.check().vertices_inside == brute_force(stack).vertices_inside);
    CHECK(stack.check().vertices_inside > 100);
  }
  SECTION("a small cell in the dimple is outside, below the floor of the dimple inside") {
    const Mesh bead = sphere_mesh(0.8, 2);
    stack.add(cell, Vector3(20, 20, 20));
    stack.add(bead, Vector3(20, 20, 20 + 0.1035 * 9 + 0.85));  // under the rim: 0.3276 * 9 = 2.9
    CHECK(stack.check().is_clean());
    stack.positions[1] = place_mesh(bead, Vector3(20, 20, 20), {1, 0, 0, 0});
    CHECK(stack.check().vertices_inside == 42);
  }
}

TEST_CASE("overlap: random arrangement against brute force", "[overlap]") {
  const bool walls = GENERATE(true, false);
  Arrangement a;
  a.box = {16, 18, 20};
  a.walls = walls;
  RandomStream random(11);
  const Mesh mesh = red_cell_mesh(4, 4);
  for (int i = 0; i < 10; ++i) {
    const double x = random.uniform(-8, 24), y = random.uniform(-9, 27), z = random.uniform(2, 18);
    a.add(mesh, Vector3(x, y, z), random_rotation(random));
  }
  const OverlapReport report = a.check(), expected = brute_force(a);
  CHECK(report.vertices_inside == expected.vertices_inside);
  CHECK(report.vertices_inside > 10);
  CHECK(report.smallest_gap == Approx(expected.smallest_gap));
}

TEST_CASE("overlap: far apart, alone, empty, broken", "[overlap]") {
  Arrangement a;
  a.box = {200, 200, 200};
  CHECK(a.check().is_clean());
  a.add(sphere_mesh(2, 3), Vector3(100, 100, 20));
  CHECK(a.check().smallest_gap == Approx(brute_force(a).smallest_gap));  // its own image
  a.add(sphere_mesh(2, 3), Vector3(100, 100, 180));
  CHECK(a.check().smallest_gap == Approx(brute_force(a).smallest_gap));
  CHECK(a.check().is_clean());
  a.positions[1][5] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(a.check(), SimulationError);
}
