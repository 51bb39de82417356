#include "physics/vertex_motion.hpp"

#include <cmath>

#include "core/vertex_vectors.hpp"
#include "physics/membrane.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

namespace {

std::vector<CellType> one_sphere(double shear) {
  CellType type;
  type.name = "sphere";
  type.radius = 5;
  type.count = 1;
  type.reference = sphere_mesh(5, 5);
  type.moduli.shear = shear;
  type.moduli.area_dilation = 2.5 * shear;
  return {type};
}

std::vector<double> vertices_of(const Mesh& mesh) {
  std::vector<double> x;
  for (const auto& p : mesh.vertices) x.insert(x.end(), {p.x(), p.y(), p.z()});
  return x;
}

/// Where `steps` steps take a vertex whose velocity at step t is `velocity(t)`, without any force.
template <class Velocity>
double carried(VertexUpdate update, int steps, const Velocity& velocity, int interval = 1) {
  const auto types = one_sphere(0);
  VertexMotion motion(types, update, {1, 0.6}, interval);
  const auto start = vertices_of(types[0].reference);
  const auto x = to_device(start), f = to_device(std::vector<double>(start.size()));
  const ForceOperator none = [](const VertexVectors&, const VertexVectors& forces) { Kokkos::deep_copy(forces, 0.0); };
  for (int t = 0; t < steps; ++t) motion.advance(x, to_device(std::vector<double>(start.size(), velocity(t))), f, none);
  return to_host(x)[7] - start[7];
}

struct Stiff {
  explicit Stiff(double shear) : types(one_sphere(shear)), membrane(make_membrane(types[0].reference, types[0].moduli, Precision::double_precision, 0, 1)) {}
  ForceOperator force() const {
    return [this](const VertexVectors& x, const VertexVectors& f) { membrane->compute_forces(x, f); };
  }
  double energy(const VertexVectors& x) const {
    const auto values = to_host(x);
    std::vector<Vector3> points;
    for (std::size_t i = 0; i < values.size(); i += 3) points.emplace_back(values[i], values[i + 1], values[i + 2]);
    return membrane_energy(types[0].reference, types[0].moduli, points).total();
  }
  std::vector<double> dented() const {
    auto x = vertices_of(types[0].reference);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] *= 1 + 0.01 * std::sin(double(7 * i));
    return x;
  }
  std::vector<CellType> types;
  std::unique_ptr<Membrane> membrane;
};

}  // namespace

TEST_CASE("Vertices follow a steady velocity exactly", "[vertex_motion]") {
  for (const auto update : {VertexUpdate::euler, VertexUpdate::averaged, VertexUpdate::chebyshev})
    for (const int interval : {1, 4}) CHECK(carried(update, 50, [](int) { return 0.01; }, interval) == Approx(interval * 0.5).epsilon(1e-12));
}

TEST_CASE("A vertex that turns with the fluid stays on its circle, at an interval of eight steps too", "[vertex_motion]") {
  const auto types = one_sphere(0);
  const int interval = 8, turns = 100;
  VertexMotion motion(types, VertexUpdate::averaged, {1, 0.6}, interval);
  const auto start = vertices_of(types[0].reference);
  const auto x = to_device(start), u = to_device(std::vector<double>(start.size())), f = to_device(std::vector<double>(start.size()));
  const ForceOperator none = [](const VertexVectors&, const VertexVectors& forces) { Kokkos::deep_copy(forces, 0.0); };
  const double angle = 5e-4;  // a step
  for (int t = 0; t < turns; ++t) {
    auto velocity = to_host(motion.halfway(x, u));
    for (std::size_t i = 0; i < velocity.size(); i += 3) {
      const double ux = -angle * velocity[i + 1], uy = angle * velocity[i];
      velocity[i] = ux, velocity[i + 1] = uy, velocity[i + 2] = 0;
    }
    Kokkos::deep_copy(u, to_device(velocity));
    motion.advance(x, u, f, none);
  }
  const auto end = to_host(x);
  const double c = std::cos(turns * interval * angle), s = std::sin(turns * interval * angle);
  // The angle of a coupling is a = 0.004: along the tangent 100 of them would lead 100 a^2/2 = 8e-4 of the radius of 5 outwards. The first one does, its past is rest; the others are off by a^3.
  for (std::size_t i = 0; i < end.size(); i += 3) {
    CHECK(std::hypot(end[i], end[i + 1]) == Approx(std::hypot(start[i], start[i + 1])).margin(5e-5));
    CHECK(end[i] == Approx(c * start[i] - s * start[i + 1]).margin(2e-4));
  }
}

TEST_CASE("The averaged velocity has no delay and is blind to staggered motion", "[vertex_motion]") {
  // u = 0.001 t: the sum over t = 0 ... n - 1 is 0.001 n (n - 1)/2; the first two steps lack their past and are off by 0.001/4 each at most.
  CHECK(carried(VertexUpdate::averaged, 100, [](int t) { return 0.001 * t; }) == Approx(0.001 * 100 * 99 / 2).margin(0.0006));
  const auto staggered = [](int t) { return t % 2 ? -0.01 : 0.01; };
  const double after_start = carried(VertexUpdate::averaged, 2, staggered);
  CHECK(carried(VertexUpdate::averaged, 31, staggered) == Approx(after_start).margin(1e-14));
  CHECK(carried(VertexUpdate::chebyshev, 31, staggered) == Approx(after_start).margin(1e-14));
}

TEST_CASE("A stiff membrane turns and moves with the fluid as if it were soft", "[vertex_motion]") {
  const Stiff sphere(20.0);
  VertexMotion motion(sphere.types, VertexUpdate::chebyshev, {3, 0.6});
  const auto start = vertices_of(sphere.types[0].reference);
  const auto x = to_device(start), f = to_device(std::vector<double>(start.size()));
  const double angle = 1e-4, steps = 20;
  for (int t = 0; t < steps; ++t) {
    sphere.membrane->compute_forces(x, f);
    auto u = to_host(x);  // rotation about z plus a translation along z
    for (std::size_t i = 0; i < u.size(); i += 3) {
      const double ux = -angle * u[i + 1], uy = angle * u[i];
      u[i] = ux, u[i + 1] = uy, u[i + 2] = 1e-3;
    }
    motion.advance(x, to_device(u), f, sphere.force());
  }
  CHECK(motion.stages() > 5);
  const auto end = to_host(x);
  double worst = 0;
  for (std::size_t i = 0; i < end.size(); i += 3) {
    const double c = std::cos(steps * angle), s = std::sin(steps * angle);
    worst = std::max({worst, std::abs(end[i] - (c * start[i] - s * start[i + 1])), std::abs(end[i + 1] - (s * start[i] + c * start[i + 1])),
                      std::abs(end[i + 2] - (start[i + 2] + steps * 1e-3))});
  }
  // A step along the tangent leaves the circle by r angle^2/2 = 2.5e-8; twenty of them 5e-7.
  CHECK(worst < 1e-6);
}

TEST_CASE("Stages grow with the square root of the stiffness, and any stiffness relaxes", "[vertex_motion]") {
  int stages[2];
  for (int i = 0; i < 2; ++i) {
    const Stiff sphere(i == 0 ? 4.0 : 64.0);
    VertexMotion motion(sphere.types, VertexUpdate::chebyshev, {3, 0.6});
    const auto x = to_device(sphere.dented());
    const auto f = to_device(std::vector<double>(x.extent(0) * 3)), rest = to_device(std::vector<double>(x.extent(0) * 3));
    sphere.membrane->compute_forces(x, f);
    motion.advance(x, rest, f, sphere.force());
    stages[i] = motion.stages();
    const double before = sphere.energy(x);
    settle(sphere.types, {3, 0.6}, 10, x, f, sphere.force());
    CHECK(sphere.energy(x) < 0.1 * before);
  }
  CHECK(stages[0] >= 4);
  CHECK(double(stages[1]) / stages[0] == Approx(4).epsilon(0.2));
}

TEST_CASE("Nothing moves where the fluid rests, however stiff the membrane is", "[vertex_motion]") {
  // dx/ds = M [F(x) - F(x(0))] is zero at x(0): forces that the fluid holds at rest stay as they are.
  const Stiff sphere(10.0);
  VertexMotion motion(sphere.types, VertexUpdate::chebyshev, {3, 0.6});
  const auto start = sphere.dented();
  const auto x = to_device(start);
  const auto f = to_device(std::vector<double>(start.size())), rest = to_device(std::vector<double>(start.size()));
  for (int t = 0; t < 5; ++t) {
    sphere.membrane->compute_forces(x, f);
    motion.advance(x, rest, f, sphere.force());
  }
  const auto end = to_host(x);
  for (std::size_t i = 0; i < end.size(); ++i) CHECK(end[i] == Approx(start[i]).margin(1e-12));
}
