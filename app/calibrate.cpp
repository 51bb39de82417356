#include "app/calibrate.hpp"

#include <Kokkos_Core.hpp>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "physics/fluid.hpp"
#include "physics/placement.hpp"
#include "physics/suspension.hpp"

namespace corpuscle::app {
namespace {

/// Seconds a call, best of three repetitions of at least 0.1 s.
template <class Step>
double seconds_per_step(const Step& step) {
  step();  // first touch of memory, first contact lists
  double best = 1e30;
  for (int repeat = 0; repeat < 3; ++repeat) {
    Kokkos::fence();
    Kokkos::Timer timer;
    int steps = 0;
    do {
      step();
      step();
      steps += 2;
      Kokkos::fence();
    } while (timer.seconds() < 0.1);
    best = std::min(best, timer.seconds() / steps);
  }
  return best;
}

template <class Real>
double fluid_seconds(const Problem& problem, const LatticeParameters& lattice, const std::array<int, 3>& nodes, int halo) {
  FluidParameters p;
  p.nodes = nodes;
  p.halo = halo;
  p.collision = problem.accuracy.collision;
  p.relaxation_time = lattice.relaxation_time;
  p.walls = problem.box.walls;
  p.body_force = lattice.body_force;
  p.needs_force = !problem.cells.empty();
  Fluid<Real> fluid(p);
  fluid.initialise();
  return seconds_per_step([&] {
    if (p.needs_force) fluid.scatter_force();
    fluid.collide_stream();
    if (p.needs_force) fluid.gather_velocity();
  });
}

}  // namespace

Calibration calibrate(const Problem& problem, const LatticeParameters& lattice) {
  const bool single = problem.accuracy.precision == Precision::single_precision;
  const auto fluid = [&](const std::array<int, 3>& nodes) {
    const int halo = !problem.cells.empty() && problem.accuracy.delta_kernel == 4 ? 2 : 1;
    return single ? fluid_seconds<float>(problem, lattice, nodes, halo) : fluid_seconds<double>(problem, lattice, nodes, halo);
  };
  // At most about 2 M nodes, larger than the caches where the scene is.
  std::array<int, 3> nodes = lattice.nodes;
  while (double(nodes[0]) * nodes[1] * nodes[2] > 2.2e6) {
    int& longest = *std::max_element(nodes.begin(), nodes.end());
    longest = (longest + 1) / 2;
  }
  Calibration result;
  result.per_node = fluid(nodes) / (double(nodes[0]) * nodes[1] * nodes[2]);
  if (problem.cells.empty()) return result;

  // A few cells of each type side by side, flat, just not touching, in a box of their own.
  Problem small = problem;
  LatticeParameters small_lattice = lattice;
  const int along = 4, layers = 4;
  const double spacing = 2.3 * lattice.radius;
  small.box.walls = false;
  small.flow.kind = FlowKind::rest;
  small_lattice.body_force = 0;
  int vertices = 0, next = 0;
  for (auto& type : small_lattice.cells) {
    const double share = double(type.count) / std::max<double>(1, std::accumulate(lattice.cells.begin(), lattice.cells.end(), 0.0, [](double sum, const auto& t) { return sum + double(t.count); }));
    type.count = std::clamp<std::int64_t>(std::llround(share * along * along * layers), 1, along * along * layers);
    vertices += int(type.count * type.vertices);
  }
  int cells = 0;
  for (const auto& type : small_lattice.cells) cells += int(type.count);
  const int stack = (cells + along * along - 1) / (along * along);
  const int side = int(std::ceil(along * spacing));
  small_lattice.nodes = {side, side, std::max(int(std::ceil(stack * spacing)), 8)};
  auto types = make_cell_types(small, small_lattice);
  std::vector<double> positions;
  for (const auto& type : types)
    for (int c = 0; c < type.count; ++c, ++next) {
      const Vector3 centre((next % along + 0.5) * spacing, (next / along % along + 0.5) * spacing, (next / (along * along) + 0.5) * spacing);
      const auto placed = place_mesh(type.reference, centre, {1, 0, 0, 0});
      positions.insert(positions.end(), placed.begin(), placed.end());
    }
  const auto suspension = make_suspension(small, small_lattice, std::move(types), positions);
  const double coupled = seconds_per_step([&] { suspension->step(); });
  result.per_vertex = std::max(0.0, coupled - fluid(small_lattice.nodes)) / vertices;
  return result;
}

}  // namespace corpuscle::app
