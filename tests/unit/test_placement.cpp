// Random placement: no overlaps, walls kept free, reproducible; and the random numbers it rests on.
#include "physics/placement.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "core/random.hpp"
#include "tests/catch.hpp"
#include "tests/complaint.hpp"

using namespace corpuscle;

namespace {

double smallest_gap(const PlacementRequest& request, const Placement& placement) {
  double smallest = 1e300;
  for (std::size_t i = 0; i < placement.centres.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      Vector3 d = placement.centres[i] - placement.centres[j];
      for (int a = 0; a < (request.walls_z ? 2 : 3); ++a) d[a] -= request.box[a] * std::round(d[a] / request.box[a]);
      smallest = std::min(smallest, d.norm() - request.radii[i] - request.radii[j]);
    }
  return smallest;
}

PlacementRequest request_of_fraction(double fraction, std::array<double, 3> box, std::size_t count, bool walls) {
  PlacementRequest request;
  request.box = box;
  request.walls_z = walls;
  const double radius = std::cbrt(fraction * box[0] * box[1] * box[2] / (static_cast<double>(count) * 4 * std::numbers::pi / 3));
  request.radii.assign(count, radius);
  return request;
}

}  // namespace

TEST_CASE("random stream: known values, uniform moments, independent streams", "[random]") {
  static_assert(mix_bits(0x9e3779b97f4a7c15ULL) == 0xe220a8397b1dcdafULL);  // first output of splitmix64 with seed 0
  static_assert(uniform_from_bits(~0ULL) < 1.0);
  RandomStream a(7), same(7), other_stream(7, 1), other_seed(8);
  double mean = 0, square = 0, cross = 0;
  const int n = 200000;
  for (int i = 0; i < n; ++i) {
    const double x = a.uniform(), y = other_stream.uniform();
    REQUIRE(x == same.uniform());
    REQUIRE((x >= 0 && x < 1));
    mean += x / n, square += x * x / n, cross += (x - 0.5) * (y - 0.5) / n;
  }
  CHECK(mean == Approx(0.5).margin(3e-3));
  CHECK(square == Approx(1.0 / 3).margin(3e-3));
  CHECK(cross == Approx(0).margin(1e-3));
  CHECK(RandomStream(7).bits() != other_seed.bits());
  RandomStream second(7, 0, 1), from_start(7);
  from_start.bits();
  CHECK(second.bits() == from_start.bits());
}

TEST_CASE("random rotations are uniform", "[random]") {
  RandomStream random(3);
  const int n = 40000;
  Vector3 mean = Vector3::Zero(), square = Vector3::Zero();
  double w2 = 0;
  for (int i = 0; i < n; ++i) {
    const auto q = random_rotation(random);
    REQUIRE(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] == Approx(1));
    REQUIRE(q[0] >= 0);
    w2 += q[0] * q[0] / n;
    const Vector3 axis(2 * (q[1] * q[3] + q[0] * q[2]), 2 * (q[2] * q[3] - q[0] * q[1]), 1 - 2 * (q[1] * q[1] + q[2] * q[2]));  // image of z
    mean += axis / n, square += axis.cwiseProduct(axis) / n;
  }
  CHECK(mean.norm() < 0.02);
  CHECK((square - Vector3::Constant(1.0 / 3)).norm() < 0.02);
  CHECK(w2 == Approx(0.25).margin(0.01));
}

TEST_CASE("place_spheres: no overlaps, inside the box, off the walls", "[placement]") {
  const bool walls = GENERATE(true, false);
  auto request = request_of_fraction(0.25, {40, 50, 60}, 300, walls);
  request.wall_gap = 0.5;
  for (std::size_t i = 0; i < request.radii.size(); i += 3) request.radii[i] *= 0.5;  // two sizes
  const Placement placement = place_spheres(request);
  REQUIRE(placement.centres.size() == 300);
  REQUIRE(placement.orientations.size() == 300);
  CHECK(smallest_gap(request, placement) >= -1e-12);
  for (std::size_t i = 0; i < 300; ++i) {
    for (int a = 0; a < 3; ++a) CHECK((placement.centres[i][a] >= 0 && placement.centres[i][a] <= request.box[a]));
    if (walls) {
      CHECK(placement.centres[i].z() >= request.radii[i] + 0.5);
      CHECK(placement.centres[i].z() <= 60 - request.radii[i] - 0.5);
    }
  }
}

TEST_CASE("place_spheres: spheres as large as the box allows for", "[placement]") {
  PlacementRequest request;
  request.box = {10, 10, 12};
  request.radii = {5};
  request.wall_gap = 1;
  CHECK(place_spheres(request).centres[0].z() == Approx(6));
  request.radii = {5.01};
  CHECK(complaint_lacks([&] { place_spheres(request); }, {"Cell 0", "along x"}) == "");
  request.box = {20, 20, 12};
  CHECK(complaint_lacks([&] { place_spheres(request); }, {"along z"}) == "");
  request.walls_z = false;
  CHECK_NOTHROW(place_spheres(request));
  request.radii = {-1};
  CHECK_THROWS_AS(place_spheres(request), InputError);
  request.radii = {};
  CHECK(place_spheres(request).centres.empty());
}

TEST_CASE("place_spheres: reproducible; the seed and only the seed changes it", "[placement]") {
  auto request = request_of_fraction(0.2, {30, 30, 30}, 50, true);
  const Placement first = place_spheres(request), again = place_spheres(request);
  CHECK(first.centres == again.centres);
  CHECK(first.orientations == again.orientations);
  request.seed = 2;
  CHECK(place_spheres(request).centres != first.centres);
}

TEST_CASE("place_spheres: the same numbers on every machine", "[placement]") {
  PlacementRequest request;
  request.box = {30, 30, 30};
  request.radii.assign(50, 2.9);
  const Placement placement = place_spheres(request);
  CHECK((placement.centres[0] - Vector3(1.088901716270958, 16.967095796975336, 7.8216039127913728)).norm() < 1e-14);
  CHECK(placement.orientations[0][0] == Approx(0.33498844996570742).epsilon(1e-15));
  CHECK(placement.orientations[0][3] == Approx(-0.62438598534387235).epsilon(1e-15));
}

TEST_CASE("place_spheres: says why it can't succeed", "[placement]") {
  CHECK(complaint_lacks([&] { place_spheres(request_of_fraction(0.5, {30, 30, 30}, 200, false)); }, {"of 200 cells", "50.0"}) == "");
}

TEST_CASE("place_mesh and rotation_to_axis", "[placement]") {
  const Mesh mesh = red_cell_mesh(2, 4);
  CHECK(bounding_radius(mesh) == Approx(2).epsilon(1e-2));
  for (const std::array<double, 3> axis : {std::array<double, 3>{1, 0, 0}, {0, 0, 1}, {0, 0, -1}, {0.3, -2, 0.1}}) {
    const UnitQuaternion q = rotation_to_axis(axis);
    Mesh pole;
    pole.vertices = {Vector3(0, 0, 1)};
    const auto x = place_mesh(pole, Vector3(1, 2, 3), q, 2);
    const Vector3 expected = Vector3(1, 2, 3) + 2 * Vector3(axis[0], axis[1], axis[2]).normalized();
    CHECK((Vector3(x[0], x[1], x[2]) - expected).norm() < 1e-12);
  }
  CHECK_THROWS_AS(rotation_to_axis({0, 0, 0}), InputError);
  const auto placed = place_mesh(mesh, Vector3(5, 5, 5), rotation_to_axis({1, 1, 0}), 0.5);
  REQUIRE(placed.size() == 3 * mesh.vertices.size());
  Mesh moved = mesh;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) moved.vertices[v] = Vector3(placed[3 * v], placed[3 * v + 1], placed[3 * v + 2]);
  CHECK(mesh_volume(moved) == Approx(mesh_volume(mesh) / 8));
  CHECK((mesh_centroid(moved) - Vector3(5, 5, 5)).norm() < 1e-10);
}
