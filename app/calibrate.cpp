#include "app/calibrate.hpp"

#include <algorithm>
#include <cmath>

#include "core/best_seconds.hpp"
#include "physics/contact.hpp"
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

/// Mean over the steps from one coupling to the next.
template <class Real>
double fluid_seconds(const FluidParameters& parameters, int coupling_every) {
  Fluid<Real> fluid(parameters);
  fluid.initialise();
  return seconds_per_step([&] {
    if (parameters.needs_force) fluid.coupled_steps(coupling_every);
    else fluid.collide_stream();
  }) / coupling_every;
}

/// Largest extent of the shapes along z, in which cells lie flat.
double largest_height(const std::vector<CellType>& types) {
  double height = 0;
  for (const auto& type : types) {
    double low = 0, high = 0;
    for (const auto& x : type.reference.vertices) low = std::min(low, x[2]), high = std::max(high, x[2]);
    height = std::max(height, high - low);
  }
  return height;
}

/// Seconds a coupling of the searches for neighbours: what one takes beyond the forces, times how often the fastest vertices leave the skin.
double search_seconds(const LatticeParameters& lattice, const Cells& cells) {
  ContactParameters parameters;
  parameters.strength = lattice.contact_strength;
  parameters.range = lattice.contact_range;
  const PeriodicBox box(Grid{lattice.nodes[0], lattice.nodes[1], lattice.nodes[2], 1}, false);
  Contact contact(box, parameters, cells.cell_of_vertex());
  auto moved = cells.positions_host();
  for (double& x : moved) x += parameters.skin;
  const VertexVectors here = cells.positions(), there = to_device(moved);
  const double with_search = best_seconds([&] { contact.add_forces(here, cells.forces()), contact.add_forces(there, cells.forces()); }, 2) / 2;
  contact.add_forces(here, cells.forces());
  const double without = best_seconds([&] { contact.add_forces(here, cells.forces()); }, 2);
  const double fastest = lattice.mach_number * speed_of_sound * lattice.coupling_every;
  return std::max(0.0, with_search - without) * std::min(1.0, fastest / (0.5 * parameters.skin));
}

}  // namespace

double Calibration::seconds_per_step(const LatticeParameters& lattice) const {
  return per_node * lattice.box_volume() + (per_vertex / lattice.coupling_every + per_vertex_sampled / double(lattice.series_every)) * double(lattice.vertices());
}

Calibration calibrate(const Problem& problem, const LatticeParameters& lattice) {
  const bool single = problem.accuracy.precision == Precision::single_precision;
  const auto fluid = [&](const std::array<int, 3>& nodes, int coupling_every) {
    FluidParameters parameters = fluid_parameters(problem, lattice);
    parameters.nodes = nodes;
    return single ? fluid_seconds<float>(parameters, coupling_every) : fluid_seconds<double>(parameters, coupling_every);
  };
  // At most about 2 M nodes, larger than the caches where the scene is.
  std::array<int, 3> nodes = lattice.nodes;
  while (double(nodes[0]) * nodes[1] * nodes[2] > 2.2e6) {
    int& longest = *std::max_element(nodes.begin(), nodes.end());
    longest = (longest + 1) / 2;
  }
  Calibration result;
  result.per_node = fluid(nodes, lattice.coupling_every) / (double(nodes[0]) * nodes[1] * nodes[2]);
  if (problem.cells.empty()) return result;

  // A few cells of each type side by side, flat, in layers as far apart as the volume fraction asks for, just not touching, in a box of their own.
  Problem small = problem;
  LatticeParameters small_lattice = lattice;
  const int along = 4, layers = 4;
  const double spacing = 2.3 * lattice.radius;
  small.box.walls = false;
  small.flow.kind = FlowKind::rest;
  small_lattice.body_force = 0;
  double all_cells = 0, cell_volume = 0;
  for (const auto& type : lattice.cells) {
    all_cells += double(type.count);
    cell_volume += double(type.count) * type.volume;
  }
  std::int64_t vertices = 0, cells = 0;
  for (auto& type : small_lattice.cells) {
    const double share = double(type.count) / std::max(1.0, all_cells);
    type.count = std::clamp<std::int64_t>(std::llround(share * along * along * layers), 1, along * along * layers);
    vertices += type.count * type.vertices;
    cells += type.count;
  }
  const std::int64_t stack = (cells + along * along - 1) / (along * along);
  auto types = make_cell_types(small, small_lattice);
  const double dense = cell_volume / std::max(1.0, all_cells) / std::max(1e-3, lattice.phi_geometric) / (spacing * spacing);
  const double layer = std::clamp(dense, largest_height(types) + 1, 2.3 * lattice.radius + 1);
  const int side = int(std::ceil(along * spacing));
  small_lattice.nodes = {side, side, std::max(int(std::ceil(double(stack) * layer)), 8)};
  std::vector<double> positions;
  int next = 0;
  for (const auto& type : types)
    for (int c = 0; c < type.count; ++c, ++next) {
      const Vector3 centre((next % along + 0.5) * spacing, (next / along % along + 0.5) * spacing, (next / (along * along) + 0.5) * layer);
      const auto placed = place_mesh(type.reference, centre, {1, 0, 0, 0});
      positions.insert(positions.end(), placed.begin(), placed.end());
    }
  const double searches = problem.contact.enabled ? search_seconds(small_lattice, Cells(types, positions)) : 0;
  small_lattice.coupling_every = 1;  // of which a step is the fluid's share, known by itself, and a coupling
  const auto suspension = make_suspension(small, small_lattice, std::move(types), positions);
  const double coupled = seconds_per_step([&] { suspension->step(); });
  const double sampled = seconds_per_step([&] { suspension->step_and_measure(); });
  result.per_vertex = (std::max(0.0, coupled - fluid(small_lattice.nodes, 1)) + searches) / double(vertices);
  result.per_vertex_sampled = std::max(0.0, sampled - coupled) / double(vertices);
  return result;
}

}  // namespace corpuscle::app
