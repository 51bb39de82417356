#include "physics/fluid.hpp"

#include <cmath>
#include <numbers>

#include "tests/catch.hpp"

using namespace corpuscle;

namespace {

FluidParameters channel(int nx, int ny, int nz, CollisionKind collision, double tau) {
  FluidParameters p;
  p.nodes = {nx, ny, nz};
  p.collision = collision;
  p.relaxation_time = tau;
  return p;
}

double viscosity(double tau) { return (tau - 0.5) / 3; }

/// ux averaged over a plane z.
double plane_mean(const std::vector<double>& u, const std::array<int, 3>& n, int z) {
  double sum = 0;
  for (int i = 0; i < n[0] * n[1]; ++i) sum += u[3 * (std::size_t(z) * n[0] * n[1] + i)];
  return sum / (n[0] * n[1]);
}

}  // namespace

TEMPLATE_TEST_CASE("Couette flow with half-way moving walls is linear to round-off", "[fluid]", float, double) {
  const double round_off = std::is_same_v<TestType, float> ? 1e-6 : 1e-14;
  for (const auto collision : {CollisionKind::bgk, CollisionKind::trt})
    for (const double tau : {0.6, 1.0, 1.7}) {
      auto p = channel(5, 3, 8, collision, tau);
      p.wall_velocity = {-0.02, 0.02};
      Fluid<TestType> fluid(p);
      fluid.initialise();
      for (int i = 0; i < 101; ++i) fluid.collide_stream();
      const auto u = fluid.velocity_host_double();
      const double rate = 0.04 / 8;
      double error = 0;
      for (int z = 0; z < 8; ++z)
        for (int i = 0; i < 15; ++i) {
          error = std::max(error, std::abs(u[3 * (z * 15 + i)] - (-0.02 + rate * (z + 0.5))));
          error = std::max(error, std::abs(u[3 * (z * 15 + i) + 1]));
          error = std::max(error, std::abs(u[3 * (z * 15 + i) + 2]));
        }
      CHECK(error < 0.04 * round_off * 10);
      const auto stress = fluid.wall_shear_stress();
      CHECK(stress[0] == Approx(viscosity(tau) * rate).epsilon(200 * round_off));
      CHECK(stress[1] == Approx(viscosity(tau) * rate).epsilon(200 * round_off));
    }
}

TEST_CASE("Couette flow develops from rest to the linear profile", "[fluid]") {
  auto p = channel(3, 3, 10, CollisionKind::trt, 1.0);
  p.wall_velocity = {-0.02, 0.03};
  Fluid<double> fluid(p);
  fluid.initialise(std::vector<double>(3 * 90, 0.0));
  for (int i = 0; i < 8000; ++i) fluid.collide_stream();
  const auto u = fluid.velocity_host_double();
  for (int z = 0; z < 10; ++z) CHECK(plane_mean(u, p.nodes, z) == Approx(-0.02 + 0.005 * (z + 0.5)).margin(1e-13));
}

TEST_CASE("Poiseuille flow: exact for TRT with Lambda = 3/16, the known slip error for BGK", "[fluid]") {
  const int height = 10;
  const double force = 1e-6;
  for (const double tau : {0.7, 1.0, 2.0})
    for (const auto collision : {CollisionKind::bgk, CollisionKind::trt}) {
      auto p = channel(3, 3, height, collision, tau);
      p.body_force = force;
      Fluid<double> fluid(p);
      fluid.initialise(std::vector<double>(3 * 9 * height, 0.0));  // from rest: the profile must develop
      const double nu = viscosity(tau);
      const int steps = int(20 * height * height / (std::numbers::pi * std::numbers::pi * nu));
      for (int i = 0; i < steps; ++i) fluid.collide_stream();
      const auto u = fluid.velocity_host_double();
      const double u_max = force * height * height / (8 * nu);
      const double magic = (tau - 0.5) * (tau - 0.5);
      const double slip = collision == CollisionKind::bgk ? u_max * (16 * magic / 3 - 1) / (height * height) : 0.0;
      for (int z = 0; z < height; ++z) {
        const double s = (z + 0.5) / height;
        CHECK(plane_mean(u, p.nodes, z) == Approx(4 * u_max * s * (1 - s) + slip).epsilon(1e-7));
      }
    }
}

TEST_CASE("A force that is held acts as one that is spread again, to the bit", "[fluid]") {
  auto p = channel(5, 4, 6, CollisionKind::trt, 0.8);
  p.needs_force = true;
  p.wall_velocity = {-0.01, 0.01};
  p.body_force = 1e-6;
  Fluid<double> held(p), spread(p);
  held.initialise();
  spread.initialise();
  const auto set_force = [](const Fluid<double>& fluid, double size) {
    const auto force = Kokkos::create_mirror_view(fluid.force());
    for (std::size_t i = 0; i < force.extent(0); ++i)
      for (int k = 0; k < 3; ++k) force(i, k) = size * std::sin(double(3 * i + k));
    Kokkos::deep_copy(fluid.force(), force);
  };
  for (const double size : {1e-4, 2e-4}) {  // three steps: begins at an even and at an odd one
    set_force(held, size);
    held.collide_stream_holding_force(3);
    for (int i = 0; i < 2; ++i) {
      set_force(spread, size);
      spread.collide_stream();
    }
    const auto before = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, spread.velocity());
    const VectorField<double>::HostMirror last_but_one("last_but_one", before.extent(0));
    Kokkos::deep_copy(last_but_one, before);  // on the host the mirror is the field itself
    set_force(spread, size);
    spread.collide_stream();
    CHECK(held.step() == spread.step());
    int different = 0;
    for (int q = 0; q < 19; ++q) different += held.population(q) != spread.population(q);
    CHECK(different == 0);
    const auto u = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, held.velocity()), v = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, spread.velocity());
    const auto left = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, held.force());
    for (int z = 0; z < 6; ++z)
      for (int k = 0; k < 3; ++k) {
        const int node = held.grid().index(1, 2, z);
        CHECK(u(node, k) == 0.5 * (last_but_one(node, k) + v(node, k)));
        CHECK(left(node, k) == 0);
      }
  }
}

TEST_CASE("coupled_steps is scatter_force, collide_stream and gather_velocity, to the bit", "[fluid]") {
  for (const bool walls : {true, false})
    for (const int steps : {1, 3})
      for (const std::array<int, 3>& nodes : {std::array{7, 5, 6}, std::array{2, 3, 4}}) {  // the second has fewer nodes than two layers of its halo
        auto p = channel(nodes[0], nodes[1], nodes[2], CollisionKind::trt, 0.8);
        p.walls = walls;
        p.needs_force = true;
        p.halo = 2;
        if (walls) p.wall_velocity = {-0.01, 0.01};
        CAPTURE(walls, steps, nodes[0]);
        Fluid<float> at_once(p), one_by_one(p);
        at_once.initialise();
        one_by_one.initialise();
        for (int round = 0; round < 3; ++round) {
          for (const Fluid<float>* fluid : {&at_once, &one_by_one}) {
            const auto force = Kokkos::create_mirror_view(fluid->force());
            for (std::size_t i = 0; i < force.extent(0); ++i)
              for (int k = 0; k < 3; ++k) force(i, k) = 1e-4f * std::sin(float(3 * i + k + round));
            Kokkos::deep_copy(fluid->force(), force);
          }
          at_once.coupled_steps(steps);
          one_by_one.scatter_force();
          one_by_one.collide_stream_holding_force(steps);
          one_by_one.gather_velocity();
          int different = 0;
          for (int q = 0; q < 19; ++q) different += at_once.population(q) != one_by_one.population(q);
          const auto u = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, at_once.velocity()), v = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, one_by_one.velocity());
          for (std::size_t i = 0; i < u.extent(0); ++i)
            for (int k = 0; k < 3; ++k) different += u(i, k) != v(i, k);
          CHECK(different == 0);
        }
      }
}

TEST_CASE("A channel flow starts with its parabola", "[fluid]") {
  auto p = channel(3, 3, 12, CollisionKind::trt, 0.8);
  p.body_force = 1e-6;
  Fluid<double> fluid(p);
  fluid.initialise();
  for (int i = 0; i < 50; ++i) fluid.collide_stream();
  const auto u = fluid.velocity_host_double();
  for (int z = 0; z < 12; ++z) CHECK(plane_mean(u, p.nodes, z) == Approx(1e-6 / (2 * viscosity(0.8)) * (z + 0.5) * (12 - z - 0.5)).epsilon(2e-3));
}

TEST_CASE("Taylor-Green vortex decays with nu = (tau - 1/2)/3 and converges at second order", "[fluid]") {
  // Diffusive scaling: Ma ~ 1/n, so that compressibility errors fall with the square of n as well.
  double errors[2];
  int k = 0;
  for (const int n : {16, 32}) {
    const double tau = 0.8, nu = viscosity(tau), wave = 2 * std::numbers::pi / n, amplitude = 0.02 * 16 / n;
    auto p = channel(n, 2, n, CollisionKind::bgk, tau);
    p.walls = false;
    Fluid<double> fluid(p);
    std::vector<double> u0(std::size_t(3) * n * 2 * n);
    const auto ux = [&](int x, int z) { return amplitude * std::sin(wave * (x + 0.5)) * std::cos(wave * (z + 0.5)); };
    for (int z = 0; z < n; ++z)
      for (int y = 0; y < 2; ++y)
        for (int x = 0; x < n; ++x) {
          u0[3 * ((z * 2 + y) * n + x)] = ux(x, z);
          u0[3 * ((z * 2 + y) * n + x) + 2] = -amplitude * std::cos(wave * (x + 0.5)) * std::sin(wave * (z + 0.5));
        }
    fluid.initialise(u0);
    const int steps = n * n / 4;
    for (int i = 0; i < steps; ++i) fluid.collide_stream();
    const auto u = fluid.velocity_host_double();
    double kinetic = 0, reference = 0;
    for (int z = 0; z < n; ++z)
      for (int x = 0; x < n; ++x) {
        kinetic += u[3 * ((z * 2) * n + x)] * ux(x, z);
        reference += ux(x, z) * ux(x, z);
      }
    const double decay = -std::log(kinetic / reference) / (2 * wave * wave * steps);
    errors[k++] = std::abs(decay / nu - 1);
  }
  CHECK(errors[1] < 4e-3);
  CHECK(std::log2(errors[0] / errors[1]) > 1.7);
}

TEMPLATE_TEST_CASE("A periodic box conserves mass and momentum to round-off", "[fluid]", float, double) {
  const double round_off = std::is_same_v<TestType, float> ? 1e-7 : 1e-16;
  auto p = channel(7, 5, 6, CollisionKind::trt, 0.9);
  p.walls = false;
  Fluid<TestType> fluid(p);
  std::vector<double> u0(3 * 7 * 5 * 6);
  for (std::size_t i = 0; i < u0.size(); ++i) u0[i] = 0.05 * std::sin(12.9898 * double(i + 1));
  fluid.initialise(u0);
  const double mass = fluid.mass_shift();
  const auto before = fluid.momentum();
  for (int i = 0; i < 201; ++i) fluid.collide_stream();
  const auto after = fluid.momentum();
  // Each step rounds 19 populations of every node once: errors add up like a random walk over nodes and steps.
  const double bound = 10 * round_off * 0.1 * std::sqrt(210. * 201 * 19);
  CHECK(std::abs(fluid.mass_shift() - mass) < bound);
  for (int k = 0; k < 3; ++k) CHECK(std::abs(after[k] - before[k]) < bound);
}

TEMPLATE_TEST_CASE("Staggered momentum stays and turns its sign, until a force takes it away", "[fluid]", float, double) {
  const double round_off = std::is_same_v<TestType, float> ? 1e-8 : 1e-16, amplitude = 1e-3;
  for (const bool walls : {true, false})
    for (const auto collision : {CollisionKind::bgk, CollisionKind::trt}) {
      auto p = channel(8, 6, 10, collision, 1.3);
      p.walls = walls;
      p.needs_force = true;
      Fluid<TestType> fluid(p);
      for (int k = 0; k < (walls ? 2 : 3); ++k) {
        std::vector<double> velocity(3 * 8 * 6 * 10);
        for (int i = 0; i < 8 * 6 * 10; ++i) {
          const int at[] = {i % 8, i / 8 % 6, i / 48};
          velocity[3 * i + k] = at[k] % 2 == 0 ? amplitude : -amplitude;
        }
        fluid.initialise(velocity);
        CHECK(fluid.staggered_momentum()[k] == Approx(amplitude).epsilon(1e-4));
        fluid.coupled_steps(1);
        if (!walls) CHECK(fluid.staggered_momentum()[k] == Approx(-amplitude).epsilon(1e-4));  // walls take a part of it
        CHECK(std::abs(fluid.staggered_momentum()[k]) > amplitude / 2);
        fluid.remove_staggered_momentum();
        fluid.coupled_steps(1);
        CHECK(std::abs(fluid.staggered_momentum()[k]) < (walls ? amplitude / 2 : 10 * round_off));
      }
    }
  auto p = channel(7, 5, 9, CollisionKind::trt, 1);
  p.walls = false;
  Fluid<TestType> odd(p);
  odd.initialise();
  CHECK(odd.staggered_momentum() == std::array<double, 3>{});
}

TEST_CASE("In-place streaming moves a population packet by one node a step in every direction and parity", "[fluid]") {
  // With tau -> infinity nothing relaxes: a single disturbed node must appear, unchanged in total, at x + c after each step, across all periodic sides.
  auto p = channel(4, 5, 6, CollisionKind::bgk, 1e12);
  p.walls = false;
  Fluid<double> fluid(p);
  std::vector<double> u0(3 * 4 * 5 * 6, 0.0);
  const int x0 = 3, y0 = 0, z0 = 5;
  u0[3 * ((z0 * 5 + y0) * 4 + x0)] = 0.01;
  fluid.initialise(u0);
  for (int step = 1; step <= 5; ++step) {
    fluid.collide_stream();
    const auto u = fluid.velocity_host_double();
    // c_x = +1 carries +momentum, c_x = -1 carries the opposite sign of population deviation, hence also +momentum along x.
    const auto at = [&](int x, int y, int z) { return u[3 * (((z + 6) % 6 * 5 + (y + 5 * 2) % 5) * 4 + (x + 8) % 4)]; };
    const double axis = 2 * 3.0 / 18 * 0.01 / 2;
    if (step < 2) {
      CHECK(at(x0 + step, y0, z0) == Approx(axis).epsilon(0.05));
      CHECK(at(x0 - step, y0, z0) == Approx(axis).epsilon(0.05));
      CHECK(at(x0 + step, y0 + step, z0) == Approx(axis / 2).epsilon(0.05));
      CHECK(at(x0 - step, y0 - step, z0) == Approx(axis / 2).epsilon(0.05));
      CHECK(at(x0 + step, y0, z0 + step) == Approx(axis / 2).epsilon(0.05));
      CHECK(at(x0 - step, y0, z0 + step) == Approx(axis / 2).epsilon(0.05));
      CHECK(at(x0 - step, y0 + step, z0) == Approx(axis / 2).epsilon(0.05));
    }
  }
}
