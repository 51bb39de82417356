#include "physics/contact.hpp"

#include <cmath>

#include "core/error.hpp"
#include "core/random.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

namespace {

struct Scattered {
  VertexVectors positions, forces;
  Array1<int> cell;
};
Scattered scatter(int count, const double (&length)[3], int vertices_per_cell, std::uint64_t seed) {
  Scattered s{VertexVectors("x", count), VertexVectors("F", count), Array1<int>("cell", count)};
  auto x = Kokkos::create_mirror_view(s.positions);
  auto c = Kokkos::create_mirror_view(s.cell);
  RandomStream random(seed);
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) x(i, k) = random.uniform(0, length[k]) + (k < 2 ? length[k] * (i % 3 - 1) : 0);
    c(i) = i / vertices_per_cell;
  }
  Kokkos::deep_copy(s.positions, x);
  Kokkos::deep_copy(s.cell, c);
  return s;
}

/// Cells of `per_cell` vertices within 0.7 of their centres, so small that none reaches its own images.
Scattered compact(int count, const double (&length)[3], int per_cell, std::uint64_t seed) {
  auto s = scatter(count, length, per_cell, seed);
  const auto x = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, s.positions);
  RandomStream random(seed + 1);
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < 3; ++k)
      if (i % per_cell != 0) x(i, k) = x(i - i % per_cell, k) + random.uniform(-0.4, 0.4);
  Kokkos::deep_copy(s.positions, x);
  return s;
}

}  // namespace

TEST_CASE("Contact forces equal the sum over all pairs, in boxes of any size", "[contact]") {
  struct Box {
    double length[3];
    int count;
  };
  for (const Box& b : {Box{{8, 9, 10}, 400}, Box{{2, 3, 12}, 100}, Box{{1.7, 20, 3.3}, 120}, Box{{4, 4, 2}, 60}})
    for (const int kind : {0, 1, 2, 3}) {
      const bool walls = kind % 2 == 1;
      const PeriodicBox box(b.length[0], b.length[1], b.length[2], walls);
      const auto s = kind < 2 ? scatter(b.count, b.length, 7, 3) : compact(b.count, b.length, 7, 3);
      const double range = 0.8;
      Contact contact(box, {0.3, range, 0.05}, s.cell);
      contact.add_forces(s.positions, s.forces);
      const auto x = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, s.positions);
      const auto f = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, s.forces);
      const Repulsion repulsion{0.3, range};
      double total[3] = {}, wall = 0;
      for (int i = 0; i < b.count; ++i) {
        double expected[3] = {};
        for (int j = 0; j < b.count; ++j) {
          double d[3], square = 0;
          bool same = true;
          for (int k = 0; k < 3; ++k) {
            d[k] = x(i, k) - x(j, k);
            const double raw = d[k];
            if (k < 2 || !walls) d[k] -= b.length[k] * std::round(d[k] / b.length[k]);
            same = same && raw == d[k];
            square += d[k] * d[k];
          }
          if (i == j || (same && i / 7 == j / 7) || square >= range * range) continue;
          const double distance = std::sqrt(square);
          for (int k = 0; k < 3; ++k) expected[k] += repulsion.magnitude(distance) * d[k] / distance;
        }
        if (walls) {
          expected[2] += repulsion.magnitude(x(i, 2)) - repulsion.magnitude(b.length[2] - x(i, 2));
          wall += repulsion.magnitude(x(i, 2)) - repulsion.magnitude(b.length[2] - x(i, 2));
        }
        for (int k = 0; k < 3; ++k) {
          CHECK(f(i, k) == Approx(expected[k]).margin(1e-10));
          total[k] += f(i, k);
        }
      }
      CHECK(total[0] == Approx(0).margin(1e-9));
      CHECK(total[2] == Approx(wall).margin(1e-9));
    }
}

TEST_CASE("Forces of moving vertices have the same bits whenever the neighbour lists were built", "[contact]") {
  // So a run that is resumed, with lists of its own, goes on as if it had not been interrupted.
  const double length[3] = {10, 10, 10};
  const PeriodicBox box(Grid{10, 10, 10, 1}, false);
  for (const bool small_cells : {false, true})
    for (const double expected_move : {0.0, 0.04}) {
      const auto s = small_cells ? compact(500, length, 5, 9) : scatter(500, length, 5, 9);
      Contact kept(box, {0.1, 1.0, 0.6, expected_move}, s.cell);
      auto x = Kokkos::create_mirror_view(s.positions);
      Kokkos::deep_copy(x, s.positions);
      for (int step = 0; step < 60; ++step) {
        Kokkos::deep_copy(s.forces, 0.0);
        kept.add_forces(s.positions, s.forces);
        VertexVectors fresh_forces("F", 500);
        Contact fresh(box, {0.1, 1.0, 0.0}, s.cell);
        fresh.add_forces(s.positions, fresh_forces);
        const auto a = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, s.forces);
        const auto b = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, fresh_forces);
        bool equal = true;
        for (int i = 0; i < 500; ++i)
          for (int k = 0; k < 3; ++k) equal = equal && a(i, k) == b(i, k);
        REQUIRE(equal);
        // A rest of ten steps, then at full speed at once: the lists must follow.
        const double speed = step % 30 < 10 ? 0.001 : 1;
        for (int i = 0; i < 500; ++i) {
          x(i, 0) += speed * (i / 5 % 2 ? 0.02 : -0.02);
          x(i, 1) += speed * 0.03 * std::cos(2.0 * (i / 5) - step);
        }
        Kokkos::deep_copy(s.positions, x);
      }
      CHECK(kept.rebuilds() > 2);
      CHECK(kept.rebuilds() < 20);
    }
}

TEST_CASE("The search for contacts ends a run in which thousands of vertices lie in one place, instead of looking at all pairs", "[contact]") {
  const double length[3] = {20, 20, 20};
  const PeriodicBox box(20, 20, 20, true);
  const auto s = scatter(40000, length, 100, 3);
  Contact contact(box, {0.3, 1.0, 0.6}, s.cell);
  contact.add_forces(s.positions, s.forces);
  CHECK(contact.rebuilds() == 1);
  auto x = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, s.positions);
  for (int v = 0; v < 20000; ++v) x(v, 2) = 1e6, x(v, 0) = x(v, 1) = 0.5;  // beyond a wall, where they count to the last bins
  Kokkos::deep_copy(s.positions, x);
  CHECK_THROWS_AS(contact.add_forces(s.positions, s.forces), SimulationError);
  CHECK(contact.rebuilds() == 0);  // guards look at no lists now
}
