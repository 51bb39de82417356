#include "physics/coupling.hpp"

#include <cmath>

#include "core/lattice_for.hpp"
#include "kernels/delta_kernel.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

namespace {

template <class Delta>
void check_moments(double sum_of_squares) {
  for (int i = 0; i < 1000; ++i) {
    const double s = -3.0 + 0.00731 * i;
    double w[Delta::width], sum = 0, first = 0, square = 0;
    const double base = Delta::first(s);
    Delta::weights(s - base, w);
    for (int k = 0; k < Delta::width; ++k) {
      sum += w[k];
      first += w[k] * (base + k - s);
      square += w[k] * w[k];
      CHECK(w[k] >= -1e-15);
    }
    CHECK(sum == Approx(1).margin(1e-14));
    CHECK(first == Approx(0).margin(1e-14));
    if (sum_of_squares > 0) CHECK(square == Approx(sum_of_squares).margin(1e-14));
  }
}

VertexVectors random_vectors(const std::string& name, int count, double low, double high, int seed) {
  VertexVectors v(name, count);
  auto host = Kokkos::create_mirror_view(v);
  unsigned state = 2654435761u * seed;
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < 3; ++k) {
      state = state * 1664525u + 1013904223u;
      host(i, k) = low + (high - low) * (state >> 8) / double(1 << 24);
    }
  Kokkos::deep_copy(v, host);
  return v;
}

}  // namespace

TEST_CASE("Delta kernels have the moments they claim at every offset", "[coupling]") {
  check_moments<Delta2>(0);
  check_moments<Delta3>(0.5);
  check_moments<Delta4>(0.375);
}

TEST_CASE("Delta kernels equal the published formulas", "[coupling]") {
  const auto phi3 = [](double x) {
    x = std::abs(x);
    return x <= 0.5 ? (1 + std::sqrt(1 - 3 * x * x)) / 3 : x <= 1.5 ? (5 - 3 * x - std::sqrt(-2 + 6 * x - 3 * x * x)) / 6 : 0.0;
  };
  const auto phi4 = [](double x) {
    x = std::abs(x);
    return x <= 1 ? (3 - 2 * x + std::sqrt(1 + 4 * x - 4 * x * x)) / 8 : x <= 2 ? (5 - 2 * x - std::sqrt(-7 + 12 * x - 4 * x * x)) / 8 : 0.0;
  };
  for (double s = 0; s < 1; s += 0.013) {
    double w3[3], w4[4];
    Delta3::weights(s - Delta3::first(s), w3);
    Delta4::weights(s - Delta4::first(s), w4);
    for (int k = 0; k < 3; ++k) CHECK(w3[k] == Approx(phi3(Delta3::first(s) + k - s)).margin(1e-12));
    for (int k = 0; k < 4; ++k) CHECK(w4[k] == Approx(phi4(Delta4::first(s) + k - s)).margin(1e-12));
  }
}

TEST_CASE("Spreading conserves force and torque, and is adjoint to interpolation", "[coupling]") {
  for (const int points : {2, 3, 4})
    for (const bool walls : {false, true}) {
      FluidParameters p;
      p.nodes = {9, 8, 10};
      p.walls = walls;
      p.wall_velocity = {0, 0};
      p.needs_force = true;
      p.halo = Coupling<double>::halo_width(points);
      Fluid<double> fluid(p);
      Coupling<double> coupling(fluid.grid(), walls, points);
      // With walls the vertices stay away from them: the image forces are tested on their own below.
      const auto positions = random_vectors("x", 50, walls ? 2.5 : -20, walls ? 7.5 : 30, 1);
      const auto forces = random_vectors("F", 50, -1, 1, 2);
      coupling.spread(positions, forces, fluid.force());
      fluid.scatter_force();
      const auto field = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, fluid.force());
      const auto F = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, forces);
      double total[3] = {}, expected[3] = {};
      for (int z = 0; z < 10; ++z)
        for (int y = 0; y < 8; ++y)
          for (int x = 0; x < 9; ++x)
            for (int k = 0; k < 3; ++k) total[k] += field(fluid.grid().index(x, y, z), k);
      for (int v = 0; v < 50; ++v)
        for (int k = 0; k < 3; ++k) expected[k] += F(v, k);
      for (int k = 0; k < 3; ++k) CHECK(total[k] == Approx(expected[k]).margin(1e-13));

      // Adjoint: sum_v F_v . u_v = sum_x f(x) . u(x) for an arbitrary velocity field.
      auto u = Kokkos::create_mirror_view(fluid.velocity());
      double power_nodes = 0;
      for (int z = 0; z < 10; ++z)
        for (int y = 0; y < 8; ++y)
          for (int x = 0; x < 9; ++x)
            for (int k = 0; k < 3; ++k) {
              const int node = fluid.grid().index(x, y, z);
              u(node, k) = std::sin(1.7 * x + 2.3 * y - 1.1 * z + k);
              power_nodes += u(node, k) * field(node, k);
            }
      Kokkos::deep_copy(fluid.velocity(), u);
      fluid.gather_velocity();
      VertexVectors velocities("u", 50);
      coupling.interpolate(positions, velocities, fluid.velocity());
      const auto U = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, velocities);
      double power_vertices = 0;
      for (int v = 0; v < 50; ++v)
        for (int k = 0; k < 3; ++k) power_vertices += F(v, k) * U(v, k);
      CHECK(power_vertices == Approx(power_nodes).epsilon(1e-12));
    }
}

TEST_CASE("The first moment of a spread force is its torque arm", "[coupling]") {
  for (const int points : {2, 3, 4}) {
    FluidParameters p;
    p.nodes = {12, 12, 12};
    p.walls = false;
    p.needs_force = true;
    p.halo = 2;
    Fluid<double> fluid(p);
    Coupling<double> coupling(fluid.grid(), false, points);
    const auto positions = random_vectors("x", 20, 3, 9, 3);
    const auto forces = random_vectors("F", 20, -1, 1, 4);
    coupling.spread(positions, forces, fluid.force());
    const auto field = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, fluid.force());
    const auto x = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, positions);
    const auto F = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, forces);
    double torque[3] = {}, expected[3] = {};
    for (int i = 0; i < 12 * 12 * 12; ++i) {
      const double r[3] = {i % 12 + 0.5, i / 12 % 12 + 0.5, i / 144 + 0.5};
      const int node = fluid.grid().index(i % 12, i / 12 % 12, i / 144);
      for (int k = 0; k < 3; ++k)
        torque[k] += r[(k + 1) % 3] * field(node, (k + 2) % 3) - r[(k + 2) % 3] * field(node, (k + 1) % 3);
    }
    for (int v = 0; v < 20; ++v)
      for (int k = 0; k < 3; ++k) expected[k] += x(v, (k + 1) % 3) * F(v, (k + 2) % 3) - x(v, (k + 2) % 3) * F(v, (k + 1) % 3);
    for (int k = 0; k < 3; ++k) CHECK(torque[k] == Approx(expected[k]).margin(1e-12));
  }
}

TEST_CASE("At a no-slip wall a vertex moves with the wall and its force goes into the wall", "[coupling]") {
  for (const int points : {2, 3, 4}) {
    FluidParameters p;
    p.nodes = {8, 8, 8};
    p.wall_velocity = {-0.01, 0.02};
    p.needs_force = true;
    p.halo = 2;
    Fluid<double> fluid(p);
    fluid.initialise();
    Coupling<double> coupling(fluid.grid(), true, points);
    VertexVectors positions("x", 3), forces("F", 3), velocities("u", 3);
    auto x = Kokkos::create_mirror_view(positions);
    auto F = Kokkos::create_mirror_view(forces);
    x(0, 0) = 3.3, x(0, 1) = 4.1, x(0, 2) = 0;
    x(1, 0) = 1.3, x(1, 1) = 2.1, x(1, 2) = 8;
    x(2, 0) = 5.3, x(2, 1) = 2.9, x(2, 2) = 0.4;
    for (int v = 0; v < 3; ++v) F(v, 0) = 1, F(v, 1) = 0, F(v, 2) = 0;
    Kokkos::deep_copy(positions, x);
    Kokkos::deep_copy(forces, F);
    coupling.spread(positions, forces, fluid.force());
    const auto on_walls = fluid.wall_force_from_spreading();
    fluid.scatter_force();
    const auto field = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, fluid.force());
    double on_fluid = 0;
    for (int z = 0; z < 8; ++z)
      for (int y = 0; y < 8; ++y)
        for (int i = 0; i < 8; ++i) on_fluid += field(fluid.grid().index(i, y, z), 0);
    CHECK(on_fluid + (on_walls[0] + on_walls[1]) * 64 == Approx(3).epsilon(1e-12));
    CHECK(on_walls[1] * 64 == Approx(1).epsilon(1e-12));
    fluid.collide_stream();
    fluid.gather_velocity();
    coupling.interpolate(positions, velocities, fluid.velocity());
    const auto u = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, velocities);
    CHECK(u(0, 0) == Approx(-0.01).margin(1e-10));
    CHECK(u(1, 0) == Approx(0.02).margin(1e-10));
  }
}

TEMPLATE_TEST_CASE("Coloured and atomic spreading agree", "[coupling]", float, double) {
  for (const int points : {2, 3, 4})
    for (const int nz : {4, 5, 7, 16}) {
      const Grid grid{8, 9, nz, 2};
      const auto positions = random_vectors("x", 500, 0, nz, 5);
      const auto forces = random_vectors("F", 500, -1, 1, 6);
      VectorField<TestType> coloured("coloured", grid.padded_nodes()), atomic("atomic", grid.padded_nodes());
      Coupling<TestType>(grid, false, points).spread(positions, forces, coloured);
      Coupling<TestType>(grid, false, points, SpreadMode::atomic).spread(positions, forces, atomic);
      const auto a = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, coloured);
      const auto b = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, atomic);
      double worst = 0, norm = 0;
      for (std::size_t i = 0; i < a.extent(0); ++i)
        for (int k = 0; k < 3; ++k) {
          worst = std::max(worst, double(std::abs(a(i, k) - b(i, k))));
          norm = std::max(norm, double(std::abs(a(i, k))));
        }
      CHECK(norm > 0);
      CHECK(worst < (std::is_same_v<TestType, float> ? 1e-5 : 1e-14));
    }
}
