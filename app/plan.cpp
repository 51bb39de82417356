#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/calibrate.hpp"
#include "app/commands.hpp"
#include "core/types.hpp"
#include "io/lattice_numbers.hpp"
#include "io/progress.hpp"
#include "io/scene.hpp"
#include "physics/memory.hpp"
#include "physics/model_effects.hpp"
#include "physics/resolution_choice.hpp"

namespace corpuscle::app {
namespace {

std::vector<std::string> active_models(const Problem& problem, const LatticeParameters& lattice) {
  std::vector<std::string> models;
  models.push_back(problem.accuracy.collision == CollisionKind::bgk ? "D3Q19 BGK" : fmt::format("D3Q19 TRT, Lambda = {:g}", problem.accuracy.magic_parameter));
  if (problem.box.walls) models.push_back("half-way bounce-back walls in z");
  if (lattice.body_force != 0) models.push_back("uniform body force along x");
  if (problem.cells.empty()) return models;
  models.push_back(fmt::format("immersed boundary, {}-point kernel{}", problem.accuracy.delta_kernel,
                               lattice.coupling_every > 1 ? fmt::format(", coupled every {} steps", lattice.coupling_every) : ""));
  for (const auto& type : lattice.cells) {
    std::string terms = type.moduli.law == StrainLawKind::skalak ? "Skalak" : "neo-Hookean";
    if (type.moduli.bending > 0) terms += " + bending";
    if (type.moduli.global_area > 0) terms += " + global area";
    if (type.moduli.volume > 0) terms += " + volume";
    models.push_back("membrane of " + type.name + ": " + terms);
  }
  for (const auto& type : lattice.cells)
    if (type.stretching_force > 0) models.push_back("external stretching force on " + type.name);
  if (problem.contact.enabled) models.push_back("contact repulsion between cells and with walls");
  return models;
}

/// Models that the scene can do without, with what they cost on this machine.
std::vector<DispensableModel> not_needed(const Problem& problem, const LatticeParameters& lattice, const Calibration& c) {
  const double step = c.seconds_per_step(lattice);
  return dispensable_models(problem, lattice, step > 0 ? std::max(0.0, 1 - c.per_node * lattice.box_volume() / step) : 0);
}

/// What else to run the scene with: settings that no cheaper one equals in accuracy, without its own.
std::vector<ResolutionChoice> alternatives(const Problem& problem) {
  std::vector<ResolutionChoice> choices = worthwhile(resolution_choices(problem));
  std::erase_if(choices, [&](const auto& c) { return c.radius == problem.accuracy.radius && c.delta_kernel == problem.accuracy.delta_kernel; });
  return choices;
}

/// NaN becomes null when it is written.
nlohmann::json to_json(const Problem& problem, const LatticeParameters& l, const MemoryEstimate& memory, double seconds, const Calibration& c) {
  nlohmann::json j;
  j["nodes"] = l.nodes;
  for (const auto& [name, value] : named_numbers(l)) j[name] = value;
  j["steps"] = l.steps;
  j["series_every_steps"] = l.series_every;
  j["snapshot_every_steps"] = l.snapshot_every;
  j["coupling_every_steps"] = l.coupling_every;
  for (const auto& limit : l.limits) j["limits"].push_back({{"name", limit.name}, {"shear_rate", limit.shear_rate}});
  for (const auto& m : l.margins) j["stability"].push_back({{"name", m.name}, {"value", m.value}, {"limit", m.limit}});
  j["warnings"] = l.warnings;
  for (const auto& t : l.cells) {
    nlohmann::json cells{{"name", t.name}};
    for (const auto& [name, value] : named_integers(t)) cells[name] = value;
    for (const auto& [name, value] : named_numbers(t)) cells[name] = value;
    j["cells"].push_back(cells);
  }
  j["models"] = active_models(problem, l);
  const ResolutionError resolution = viscosity_resolution_error(problem, l);
  j["viscosity_resolution_error"] = {{"value", resolution.value}, {"uncertainty", resolution.uncertainty}, {"reason", resolution.reason}};
  j["alternatives"] = nlohmann::json::array();
  for (const auto& a : alternatives(problem))
    j["alternatives"].push_back({{"radius", a.radius},
                                 {"delta_kernel", a.delta_kernel},
                                 {"viscosity_resolution_error", a.error.value},
                                 {"viscosity_resolution_error_uncertainty", a.error.uncertainty},
                                 {"relative_time", a.cost / resolution_cost(problem, l)}});
  j["not_needed"] = nlohmann::json::array();
  for (const auto& m : not_needed(problem, l, c))
    j["not_needed"].push_back({{"model", m.model},
                               {"left_out_by", m.left_out_by},
                               {"viscosity_change", m.viscosity_change},
                               {"deformation_change", m.deformation_change},
                               {"saved", m.saved},
                               {"measured", m.measured}});
  j["predicted_bytes"] = memory.suspension();
  j["predicted_bytes_peak"] = memory.peak();
  j["predicted_seconds"] = seconds;
  j["seconds_per_node"] = c.per_node;
  j["seconds_per_vertex"] = c.per_vertex;
  j["seconds_per_vertex_sampled"] = c.per_vertex_sampled;
  return j;
}

/// What the lattice stands for, as far as [si] says it.
void print_si(const LatticeParameters& l) {
  const SiUnits& si = l.si;
  if (!si.length) return;
  fmt::print("SI units    1 lattice unit = {:.4g} m", *si.length);
  if (si.time) fmt::print(", 1 step = {:.4g} s", *si.time);
  if (si.force) fmt::print(", unit of force = {:.4g} N", *si.force);
  fmt::print("\n");
  if (si.time && l.shear_rate > 0) fmt::print("            shear rate = {:.4g} 1/s\n", l.shear_rate / *si.time);
  if (si.time) fmt::print("            length of the run = {:.4g} s\n", double(l.steps) * *si.time);
  for (const auto& t : l.cells)
    if (si.force && t.stretching_force > 0) fmt::print("            stretching force on {} = {:.4g} N\n", t.name, t.stretching_force * *si.force);
}

void print_not_needed(const std::vector<DispensableModel>& models) {
  for (std::size_t i = 0; i < models.size(); ++i) {
    const auto& m = models[i];
    fmt::print("{}{}: without it eta_r - 1 changes by less than {:.2g} %, D by less than {:.2g} (measured: {}; docs/models.md); --set {} saves about {:.0f} % of a step\n",
               i == 0 ? "Not needed  " : "            ", m.model, 100 * m.viscosity_change, m.deformation_change, m.measured, m.left_out_by, 100 * m.saved);
  }
}

void print(const Problem& problem, const LatticeParameters& l, const MemoryEstimate& memory, double seconds, const Calibration& calibration) {
  const double per_step = calibration.seconds_per_step(l);
  fmt::print("Lattice     {} x {} x {} nodes, r = {:g}, tau = {:g}, viscosity = {:.6g}\n", l.nodes[0], l.nodes[1], l.nodes[2], l.radius, l.relaxation_time, l.viscosity);
  if (l.shear_rate > 0) {
    fmt::print("Flow        shear rate = {:.4g} a step, Re = {:.3g}, Ma = {:.3g}", l.shear_rate, l.reynolds_number, l.mach_number);
    if (l.capillary_number > 0) fmt::print(", Ca = {:.4g} (Ca_G = {:.4g})", l.capillary_number, 3 * l.capillary_number);
    fmt::print("\n");
    for (std::size_t i = 0; i < l.limits.size(); ++i)
      fmt::print("{}{}: shear rate <= {:.4g} ({:.3g} x the chosen one){}\n", i == 0 ? "Limits      " : "            ", l.limits[i].name, l.limits[i].shear_rate,
                 l.limits[i].shear_rate / l.shear_rate, i == 0 ? "  <- decides" : "");
  }
  for (std::size_t i = 0; i < l.margins.size(); ++i) {
    const auto& m = l.margins[i];
    fmt::print("{}{}: {:.3g}, stable up to {:.3g} ({:.0f} %)\n", i == 0 ? "Stability   " : "            ", m.name, m.value, m.limit, 100 * m.value / m.limit);
  }
  for (const auto& t : l.cells) {
    fmt::print("Cells       {} x {}: r = {:g}, {} vertices, {} faces, kappa_S = {:.4g}, kappa_alpha = {:.4g}, kappa_B = {:.4g}, kappa_A = {:.4g}, kappa_V = {:.4g}\n", t.count,
               t.name, t.radius, t.vertices, t.faces, t.moduli.shear, t.moduli.area_dilation, t.moduli.bending, t.moduli.global_area, t.moduli.volume);
  }
  for (std::size_t i = 0; i < l.cells.size(); ++i)
    fmt::print("{}effective radius of {} = {:.4g} (mesh {:.4g} + shell {:.3g})\n", i == 0 ? "Size        " : "            ", l.cells[i].name, l.cells[i].effective_radius,
               l.cells[i].mesh_radius, l.cells[i].shell_thickness);
  if (!l.cells.empty()) {
    fmt::print("Fraction    {:.4f} geometric, ", l.phi_geometric);
    if (problem.accuracy.cell_size == CellSize::hydrodynamic) fmt::print("{:.4f} nominal, ", l.phi_nominal);
    fmt::print("{:.4f} effective", l.phi_effective);
    if (l.cells[0].counted_shell != l.cells[0].shell_thickness) fmt::print(" (shell of the viscosity: {:.3g})", l.cells[0].counted_shell);
    fmt::print("\n");
  }
  print_si(l);
  bool first = true;
  for (const auto& model : active_models(problem, l)) {
    fmt::print("{}{}\n", first ? "Models      " : "            ", model);
    first = false;
  }
  if (!problem.cells.empty()) {
    const ResolutionError resolution = viscosity_resolution_error(problem, l);
    if (resolution.known())
      fmt::print("Accuracy    resolution makes the viscosity {:+.0f} ± {:.0f} % off ({}; docs/accuracy.md)\n", 100 * resolution.value, 100 * resolution.uncertainty, resolution.reason);
    else fmt::print("Accuracy    what the resolution does to the viscosity isn't known here: {} (docs/accuracy.md)\n", resolution.reason);
    for (const auto& a : alternatives(problem))
      fmt::print("            radius = {:g}, delta_kernel = {} would make it {:+.0f} ± {:.0f} %, in {:.2g} times the time\n", a.radius, a.delta_kernel, 100 * a.error.value, 100 * a.error.uncertainty,
                 a.cost / resolution_cost(problem, l));
  }
  print_not_needed(not_needed(problem, l, calibration));
  const double nodes = l.box_volume();
  fmt::print("Run         {} steps", l.steps);
  if (l.steps_per_strain > 0) fmt::print(" = {:g} strain units of {:.0f} steps", double(l.steps) / l.steps_per_strain, l.steps_per_strain);
  fmt::print("; series every {} steps", l.series_every);
  if (l.snapshot_every > 0) fmt::print(", snapshot every {}", l.snapshot_every);
  const auto mebibytes = [](std::size_t bytes) { return double(bytes) / (1 << 20); };
  fmt::print("\nMemory      {:.1f} MiB at most; while it steps {:.1f} MiB: fluid {:.1f} ({:.0f} bytes a node)", mebibytes(memory.peak()), mebibytes(memory.suspension()),
             mebibytes(memory.fluid), double(memory.fluid) / nodes);
  if (const std::int64_t vertices = l.vertices(); vertices > 0)
    fmt::print(", {} vertices {:.1f} ({:.0f} bytes each)", vertices, mebibytes(memory.suspension() - memory.fluid), double(memory.suspension() - memory.fluid) / double(vertices));
  fmt::print("\n");
  fmt::print("Time        {} predicted on this machine with {} threads ({:.1f} million node updates per second), packing and snapshots not included\n", format_duration(seconds),
             ExecSpace().concurrency(), nodes / per_step / 1e6);
}

}  // namespace

int plan(const PlanOptions& options) {
  const Problem problem = read_scene(options.scene, options.overrides);
  const LatticeParameters lattice = to_lattice(problem);
  print_warnings(lattice.warnings);
  const KokkosSession session(options.threads);
  const Calibration calibration = calibrate(problem, lattice);
  const double seconds = calibration.seconds_per_step(lattice) * double(lattice.steps);
  const MemoryEstimate memory = predict_memory(problem, lattice);
  if (options.json)
    std::cout << to_json(problem, lattice, memory, seconds, calibration).dump(2) << "\n";
  else
    print(problem, lattice, memory, seconds, calibration);
  return 0;
}

}  // namespace corpuscle::app
