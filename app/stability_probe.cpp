// From the conditions of a probe to a small simulation (class Prober).
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "app/stability_cases.hpp"
#include "core/error.hpp"
#include "core/random.hpp"
#include "physics/fluid.hpp"
#include "physics/packing.hpp"
#include "physics/placement.hpp"
#include "physics/stability_estimate.hpp"
#include "physics/stability_limits.hpp"
#include "physics/suspension.hpp"

namespace corpuscle::app {
namespace {

/// Plane Couette flow of the fluid alone, with noise of 1 % of the wall velocity: stable when the noise has decayed at the end.
StabilityVerdict probe_fluid(const ProbeScene& scene) {
  FluidParameters parameters;
  parameters.nodes = {16, 16, 16};
  parameters.collision = scene.collision;
  parameters.relaxation_time = scene.relaxation_time;
  const double wall = scene.mach * speed_of_sound;
  parameters.wall_velocity = {-wall, wall};
  Fluid<double> fluid(parameters);
  RandomStream random(1);
  std::vector<double> velocity(3 * 16 * 16 * 16), profile(velocity.size(), 0.0);
  for (std::size_t i = 0; i < velocity.size(); ++i) {
    if (i % 3 == 0) profile[i] = wall * (2 * (double(i / (3 * 256)) + 0.5) / 16 - 1);
    velocity[i] = profile[i] + 0.01 * wall * random.uniform(-1, 1);
  }
  fluid.initialise(velocity);
  const auto noise = [&](const std::vector<double>& u) {
    double sum = 0;
    for (std::size_t i = 0; i < u.size(); ++i) sum += (u[i] - profile[i]) * (u[i] - profile[i]);
    return std::sqrt(sum / double(u.size())) / wall;
  };
  StabilityVerdict verdict;
  const double before = noise(velocity);
  double middle = before;
  for (; verdict.steps < scene.steps; ++verdict.steps) {
    fluid.collide_stream();
    if (verdict.steps == scene.steps / 2) middle = noise(fluid.velocity_host_double());
  }
  verdict.jitter = noise(fluid.velocity_host_double());
  verdict.growth_rate = std::log(verdict.jitter / middle) / (0.5 * double(scene.steps));
  verdict.stable = std::isfinite(verdict.jitter) && verdict.jitter < before && verdict.jitter < 1.05 * middle;
  verdict.reason = verdict.stable ? "noise decays" : "noise grows";
  return verdict;
}

/// With another seed where a small full box can't be packed at once.
std::vector<double> pack(Problem problem, const LatticeParameters& lattice, const std::vector<CellType>& types) {
  for (problem.run.seed = 1;; ++problem.run.seed) {
    try {
      return place_cells(problem, lattice, types);
    } catch (const InputError&) {
      if (problem.run.seed == 8) throw;
    }
  }
}

/// The moduli of the probe in place of those that the scene would choose.
void set_moduli(LatticeParameters& lattice, const ProbeScene& scene) {
  const double eta = lattice.viscosity;
  auto& cell = lattice.cells[0];
  cell.moduli.shear = scene.shear * eta;
  cell.moduli.area_dilation = scene.dilation * eta;
  cell.moduli.bending = scene.bending * eta;
  cell.moduli.global_area = area_modulus(cell, scene.area);
  cell.moduli.volume = volume_modulus(cell, scene.volume);
  lattice.contact_strength = scene.contact * eta;
  lattice.contact_range = 1;
}

}  // namespace

void ProbeScene::set_red_cell(double kappa) {
  shear = kappa;
  dilation = 2.5 * kappa;
  bending = kappa * radius * radius / 405;
  contact = kappa;
}

struct Prober::Built {
  Problem problem;
  LatticeParameters lattice;
  std::vector<CellType> types;
  std::vector<double> positions;
};

Prober::Built Prober::build(const ProbeScene& scene) {
  const bool flow = scene.kind == ProbeScene::Kind::in_flow;
  Problem p;
  p.accuracy.radius = scene.radius;
  p.accuracy.delta_kernel = scene.delta_kernel;
  p.accuracy.vertex_update = scene.update;
  p.accuracy.coupling_every = scene.coupling_every;
  p.accuracy.relaxation_time = scene.relaxation_time;
  p.accuracy.precision = scene.precision;
  p.accuracy.collision = scene.collision;
  p.accuracy.allow_unstable = true;
  // What is searched for is whether the steps go on: numbers and speeds. Probes go beyond what a scene would choose; that such a state is a poor one
  // (pressed cells, a compressed fluid) is told by the guards of a run.
  constexpr double none = 1e9;
  p.guards.density = p.guards.volume_drift = p.guards.area_drift = p.guards.penetration = none;
  p.guards.collapse = 0;
  p.guards.fold = 180;
  p.accuracy.shell_thickness = 0.3;  // one for all kernels: they share a packing, so that only the kernel differs
  p.accuracy.subdivision = std::max(2, int(std::lround(scene.radius / scene.edge)));
  p.box.size = {4, 4, 4};
  p.cells.emplace_back().name = "red_cell";
  if (flow) {
    p.flow.capillary_number = 1000;  // the moduli are set below; the shear rate is what Re = 0.1 allows
    p.accuracy.mach_max = 0.3;
    p.cells[0].effective_volume_fraction = scene.phi;
  } else {
    p.flow.kind = FlowKind::rest;
    p.box.walls = false;
    p.run.steps = 1;
    p.cells[0].count = 1;
    p.contact.enabled = false;
  }
  Built built{p, to_lattice(p), {}, {}};
  auto& lattice = built.lattice;
  ProbeScene moduli = scene;
  if (scene.capillary_number > 0) moduli.set_red_cell(lattice.shear_rate * lattice.radius / scene.capillary_number);
  set_moduli(lattice, moduli);
  built.types = make_cell_types(p, lattice);
  if (!flow) {
    // Off the nodes and off their axes, so that no symmetry hides a mode.
    const Vector3 centre = 0.5 * Vector3(lattice.nodes[0], lattice.nodes[1], lattice.nodes[2]) + Vector3(0.13, 0.29, 0.41);
    built.positions = place_mesh(built.types[0].reference, centre, rotation_to_axis({0.3, 0.5, 0.8}));
    return built;
  }
  auto& packed = packed_[fmt::format("{} {} {}", scene.phi, scene.radius, scene.edge)];
  if (packed.empty()) {
    // Packed, then sheared with soft membranes until contacts have settled: a probe must not begin with the shock of a fresh packing.
    Problem soft = p;
    soft.accuracy.delta_kernel = 4;
    soft.accuracy.vertex_update = VertexUpdate::averaged;
    soft.accuracy.relaxation_time = 1;
    soft.accuracy.coupling_every = 1;
    LatticeParameters l = to_lattice(soft);
    ProbeScene moduli = scene;
    moduli.set_red_cell(0.1);
    moduli.area = ProbeScene{}.area;
    moduli.volume = ProbeScene{}.volume;
    set_moduli(l, moduli);
    const auto types = make_cell_types(soft, l);
    const auto suspension = make_suspension(soft, l, types, pack(soft, l, types));
    for (int step = 0; step < 500; ++step) suspension->step();
    suspension->check();
    packed = suspension->snapshot(false).positions;
  }
  built.positions = packed;
  return built;
}

StabilityVerdict Prober::probe(const ProbeScene& scene) {
  if (scene.kind == ProbeScene::Kind::fluid_only) return probe_fluid(scene);
  const Built b = build(scene);
  ProbeLength length;
  length.steps = scene.steps;
  return scene.kind == ProbeScene::Kind::at_rest ? probe_at_rest(b.problem, b.lattice, b.types, b.positions, length)
                                                 : probe_in_flow(b.problem, b.lattice, b.types, b.positions, length);
}

double Prober::response(const ProbeScene& scene) {
  if (scene.kind == ProbeScene::Kind::fluid_only) return std::numeric_limits<double>::quiet_NaN();
  ProbeScene alone = scene;
  alone.kind = ProbeScene::Kind::at_rest;  // the same membrane; contacts have no reference state to be linear about
  const Built b = build(alone);
  return largest_response(b.problem, b.lattice, b.types, b.positions);
}

}  // namespace corpuscle::app
