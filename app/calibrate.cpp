#include "app/calibrate.hpp"

#include <algorithm>
#include <cmath>

#include "core/best_seconds.hpp"
#include "physics/fluid.hpp"
#include "physics/placement.hpp"
#include "physics/suspension.hpp"

namespace corpuscle::app {
namespace {

/// Seconds a step; two steps a call, because the two parities of streaming may differ.
template <class Step>
double seconds_per_step(const Step& step) {
  return best_seconds([&] { step(), step(); }, 3) / 2;
}

template <class Real>
double fluid_seconds(const FluidParameters& parameters) {
  Fluid<Real> fluid(parameters);
  fluid.initialise();
  return seconds_per_step([&] {
    if (parameters.needs_force) fluid.scatter_force();
    fluid.collide_stream();
    if (parameters.needs_force) fluid.gather_velocity();
  });
}

}  // namespace

Calibration calibrate(const Problem& problem, const LatticeParameters& lattice) {
  const bool single = problem.accuracy.precision == Precision::single_precision;
  const auto fluid = [&](const std::array<int, 3>& nodes) {
    FluidParameters parameters = fluid_parameters(problem, lattice);
    parameters.nodes = nodes;
    return single ? fluid_seconds<float>(parameters) : fluid_seconds<double>(parameters);
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
  double all_cells = 0;
  for (const auto& type : lattice.cells) all_cells += double(type.count);
  std::int64_t vertices = 0, cells = 0;
  for (auto& type : small_lattice.cells) {
    const double share = double(type.count) / std::max(1.0, all_cells);
    type.count = std::clamp<std::int64_t>(std::llround(share * along * along * layers), 1, along * along * layers);
    vertices += type.count * type.vertices;
    cells += type.count;
  }
  const std::int64_t stack = (cells + along * along - 1) / (along * along);
  const int side = int(std::ceil(along * spacing));
  small_lattice.nodes = {side, side, std::max(int(std::ceil(double(stack) * spacing)), 8)};
  auto types = make_cell_types(small, small_lattice);
  std::vector<double> positions;
  int next = 0;
  for (const auto& type : types)
    for (int c = 0; c < type.count; ++c, ++next) {
      const Vector3 centre((next % along + 0.5) * spacing, (next / along % along + 0.5) * spacing, (next / (along * along) + 0.5) * spacing);
      const auto placed = place_mesh(type.reference, centre, {1, 0, 0, 0});
      positions.insert(positions.end(), placed.begin(), placed.end());
    }
  const auto suspension = make_suspension(small, small_lattice, std::move(types), positions);
  const double coupled = seconds_per_step([&] { suspension->step(); });
  result.per_vertex = std::max(0.0, coupled - fluid(small_lattice.nodes)) / double(vertices);
  return result;
}

}  // namespace corpuscle::app
