#include "physics/units.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/limit_text.hpp"
#include "physics/contact_patches.hpp"
#include "physics/hydrodynamic_size.hpp"
#include "physics/mesh.hpp"
#include "physics/shear_rate.hpp"
#include "physics/stability_limits.hpp"

namespace corpuscle {

namespace {

constexpr double penalty = 6;              // kappa_A / eta_0: 1 at tau = 1 (docs/theory/model.md, typical values)
constexpr double default_response = 0.5;    // of volume and area forces (physics/stability_limits.hpp), well inside the limits; at most the margin of stability
constexpr double packable = 0.78;          // largest phi that deformable cells reach by growing (docs/theory/model.md: 0.75 is needed)
constexpr double packable_effective = 0.92;
constexpr double most_nodes = 2e9;         // 32-bit node index
constexpr double smallest_box = 4;         // nodes; below it the kernels' halo is wider than the box

void set_fluid(const Problem& problem, LatticeParameters& lattice) {
  const double tau = problem.accuracy.relaxation_time;
  if (!(tau >= 0.505 && tau <= 5)) {
    throw InputError(fmt::format("accuracy.relaxation_time = {} must be a number >= 0.505 (below it the fluid is unstable) and <= 5 (above it inaccurate); the nearest allowed value is {}",
                                 tau, tau > 5 ? 5 : 0.505));
  }
  lattice.relaxation_time = tau;
  lattice.viscosity = (tau - 0.5) / 3;
}

void set_box(const Problem& problem, LatticeParameters& lattice) {
  lattice.radius = problem.accuracy.radius;
  double total = 1;
  for (int d = 0; d < 3; ++d) {
    const double size = problem.box.size[d];
    const double nodes = std::round(size * lattice.radius);
    if (!(nodes >= smallest_box)) {
      throw InputError(fmt::format("box.size[{}] = {} gives {} lattice nodes at accuracy.radius = {}, but {} are needed: it must be >= {}", d, size, nodes, lattice.radius,
                                   smallest_box, at_least(smallest_box / lattice.radius)));
    }
    total *= nodes;
    if (total > most_nodes) {
      throw InputError(fmt::format("box.size = [{}, {}, {}] gives more than {} lattice nodes at accuracy.radius = {}: make the box or the radius smaller", problem.box.size[0],
                                   problem.box.size[1], problem.box.size[2], most_nodes, lattice.radius));
    }
    lattice.nodes[d] = static_cast<int>(nodes);
    for (std::size_t i = 0; i < problem.cells.size(); ++i) {
      const double diameter = 2 * problem.cells[i].relative_radius;
      if (size < diameter) {
        throw InputError(fmt::format("box.size[{}] = {} is smaller than a cell of type {}, whose diameter is {} cell radii: it must be >= {}", d, size, i, diameter, diameter));
      }
    }
  }
}

Mesh mesh_of(const CellSpec& spec, const AccuracySpec& accuracy, std::size_t type, double radius, int subdivision) {
  try {
    return make_cell_mesh(spec, accuracy, radius, subdivision);
  } catch (const InputError& error) {
    throw InputError(fmt::format("cells.{}: {}", type, error.what()));
  }
}

/// Refuses a prescribed place where the cell would reach through a wall.
void check_walls(const Problem& problem, std::size_t type, const Mesh& mesh) {
  const CellSpec& spec = problem.cells[type];
  if (!spec.position || !problem.box.walls) return;
  const Vector3 axis = spec.axis ? Vector3((*spec.axis)[0], (*spec.axis)[1], (*spec.axis)[2]) : Vector3::UnitZ();
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), axis);
  double below = 0, above = 0;
  for (const Vector3& vertex : mesh.vertices) {
    const double z = (turn * vertex).z() / problem.accuracy.radius;
    below = std::max(below, -z);
    above = std::max(above, z);
  }
  const double z = (*spec.position)[2], height = problem.box.size[2];
  if (z < below || z > height - above) {
    throw InputError(fmt::format("cells.{}.position = [{}, {}, {}] puts the cell through a wall: the last number must be >= {} and <= {}", type, (*spec.position)[0],
                                 (*spec.position)[1], z, at_least(below), at_most(height - above)));
  }
}

/// Refuses contact patches that the mesh can't have.
void check_stretch(const Problem& problem, std::size_t type, const Mesh& mesh, double radius) {
  const CellSpec& spec = problem.cells[type];
  if (!spec.stretch.force) return;
  const double diameter = spec.stretch.patch_diameter;
  const ContactPatches patches = contact_patches(mesh, direction_in_reference(spec), diameter * radius);
  const auto refuse = [&](const char* what, const std::string& allowed) {
    throw InputError(fmt::format("cells.{}.stretch.patch_diameter = {} {}: it must be {}", type, diameter, what, allowed));
  };
  if (patches.ahead.empty() || patches.behind.empty()) refuse("is too small for the mesh, no vertex lies in the patch", ">= " + at_least(patches.smallest_diameter / radius));
  if (diameter * radius > patches.largest_diameter * (1 - limit_tolerance)) refuse("makes both patches overlap", "< " + at_most(patches.largest_diameter / radius));
}

/// Number of cells from the fraction that the scene gives.
std::int64_t count_of(const CellSpec& spec, std::size_t type, const CellTypeLattice& cell, double box) {
  if (spec.count) return *spec.count;
  if (!spec.volume_fraction && !spec.effective_volume_fraction) {
    throw InputError(fmt::format("cells.{}.count is missing: each cell type needs one of count, volume_fraction, effective_volume_fraction", type));
  }
  const bool geometric = spec.volume_fraction.has_value();
  const double fraction = geometric ? *spec.volume_fraction : *spec.effective_volume_fraction;
  const double one = (geometric ? cell.nominal_volume : cell.effective_volume) / box;
  const std::int64_t count = std::llround(fraction / one);
  if (count < 1) {
    throw InputError(fmt::format("cells.{}.{} = {} gives no cell in this box: it must be >= {} (one cell); raise it, enlarge the box or give count", type,
                                 geometric ? "volume_fraction" : "effective_volume_fraction", fraction, at_least(one)));
  }
  return count;
}

void set_cells(const Problem& problem, LatticeParameters& lattice) {
  const double box = lattice.box_volume();
  double vertices = 0, one = 0, with_drag_shells = 0;
  for (std::size_t i = 0; i < problem.cells.size(); ++i) {
    const CellSpec& spec = problem.cells[i];
    CellTypeLattice cell;
    cell.name = spec.name;
    cell.radius = lattice.radius * spec.relative_radius;
    const double frequency = problem.accuracy.subdivision ? *problem.accuracy.subdivision * spec.relative_radius : cell.radius;
    const int subdivision = std::max(2, static_cast<int>(std::lround(frequency)));
    const Mesh mesh = mesh_of(spec, problem.accuracy, i, cell.radius, subdivision);
    check_walls(problem, i, mesh);
    check_stretch(problem, i, mesh, cell.radius);
    cell.subdivision = spec.shape == ShapeKind::file ? 0 : subdivision;
    cell.vertices = static_cast<std::int64_t>(mesh.vertices.size());
    cell.faces = static_cast<std::int64_t>(mesh.faces.size());
    const bool nominal = problem.accuracy.cell_size == CellSize::mesh;
    cell.volume = mesh_volume(mesh);
    cell.nominal_volume = nominal ? cell.volume : mesh_volume(make_mesh(spec, cell.radius, subdivision));
    cell.shell_thickness = shell_thickness(problem.accuracy, cell.radius);
    cell.mesh_radius = nominal ? cell.radius : cell.radius - cell.shell_thickness;
    cell.effective_radius = cell.mesh_radius + cell.shell_thickness;
    cell.area = mesh_area(mesh);
    cell.edge = mean_edge(mesh);
    cell.squared_curvature = squared_curvature(mesh);
    cell.counted_shell = counted_shell(problem.accuracy, cell.radius);
    cell.effective_volume = mesh_effective_volume(mesh, cell.counted_shell);
    cell.count = count_of(spec, i, cell, box);
    lattice.phi_geometric += static_cast<double>(cell.count) * cell.volume / box;
    lattice.phi_nominal += static_cast<double>(cell.count) * cell.nominal_volume / box;
    lattice.phi_effective += static_cast<double>(cell.count) * cell.effective_volume / box;
    vertices += static_cast<double>(cell.count * cell.vertices);
    // What can be packed is known with these shells, whichever are counted.
    const double with_shell = mesh_effective_volume(mesh, cell.shell_thickness) / box;
    with_drag_shells += static_cast<double>(cell.count) * with_shell;
    one = std::max(one, with_shell);
    lattice.cells.push_back(cell);
  }
  // A fraction at the limit may round up by half a cell.
  const double excess = std::max((lattice.phi_geometric - one / 2) / packable, (with_drag_shells - one / 2) / packable_effective);
  if (excess > 1) {
    std::string keys;
    for (std::size_t i = 0; i < problem.cells.size(); ++i) {
      const CellSpec& spec = problem.cells[i];
      const auto allowed = static_cast<std::int64_t>(static_cast<double>(lattice.cells[i].count) / excess);
      keys += (i ? ", " : "") + (spec.count             ? fmt::format("cells.{}.count = {} (packable: {})", i, *spec.count, allowed)
                                 : spec.volume_fraction ? fmt::format("cells.{}.volume_fraction = {} (packable: {})", i, *spec.volume_fraction, at_most(*spec.volume_fraction / excess))
                                                        : fmt::format("cells.{}.effective_volume_fraction = {} (packable: {})", i, *spec.effective_volume_fraction,
                                                                      at_most(*spec.effective_volume_fraction / excess)));
    }
    throw InputError(fmt::format("{} fills the box to phi = {:.4g}, {:.4g} with the shells of the drag, which can't be packed: at most {} and {} are allowed; lower it or enlarge the box", keys,
                                 lattice.phi_geometric, with_drag_shells, packable, packable_effective));
  }
  if (vertices > std::numeric_limits<std::int32_t>::max()) {
    throw InputError(fmt::format("the cells have {:.3g} vertices in all, but at most {} are supported: lower the number of cells or accuracy.subdivision", vertices,
                                 std::numeric_limits<std::int32_t>::max()));
  }
}

void set_moduli(const Problem& problem, double kappa, LatticeParameters& lattice) {
  for (std::size_t i = 0; i < problem.cells.size(); ++i) {
    const MembraneSpec& spec = problem.cells[i].membrane;
    CellTypeLattice& cell = lattice.cells[i];
    const double volume_response = std::min(default_response, stability_margin * stable_response(problem.accuracy));
    const double area_response = std::min(default_response, stability_margin * stable_area_response(problem.accuracy));
    MembraneModuli& m = cell.moduli;
    m.law = spec.law;
    m.shear = kappa * problem.cells[i].relative_stiffness;
    m.area_dilation = spec.law == StrainLawKind::skalak ? spec.area_dilation * m.shear : 0;
    m.bending = spec.bending * m.shear * cell.radius * cell.radius;
    m.bending_constant = spec.bending_constant;
    // The chebyshev update has no limit on these moduli: they follow kappa_S as in the paper's stiffest runs.
    const double followed = problem.accuracy.vertex_update == VertexUpdate::chebyshev ? 5 : 0;
    // A sphere of fixed volume can't deform without gaining area, and a neo-Hookean membrane is meant to dilate: an area force there only on request.
    const bool keeps_area = spec.law == StrainLawKind::skalak && problem.cells[i].shape != ShapeKind::sphere;
    m.global_area = spec.global_area ? *spec.global_area * m.shear : keeps_area ? std::max(std::min(penalty * lattice.viscosity, area_modulus(cell, area_response)), followed * m.shear) : 0;
    m.volume = spec.volume ? *spec.volume * m.shear / cell.radius : std::max(volume_modulus(cell, volume_response), followed * m.shear);
    cell.stretching_force = problem.cells[i].stretch.force.value_or(0) * m.shear * cell.radius;
  }
  if (problem.contact.enabled && kappa > 0) {
    lattice.contact_strength = problem.contact.strength * kappa;
    lattice.contact_range = problem.contact.range;
  }
}

void set_flow(const Problem& problem, LatticeParameters& lattice) {
  const double height = lattice.nodes[2], rate = lattice.shear_rate;
  lattice.reynolds_number = rate * lattice.radius * lattice.radius / lattice.viscosity;
  if (problem.flow.kind == FlowKind::shear) {
    lattice.wall_velocity = rate * height / 2;
    lattice.mach_number = lattice.wall_velocity / speed_of_sound;
  } else if (problem.flow.kind == FlowKind::poiseuille) {
    lattice.body_force = 2 * lattice.viscosity * rate / height;
    lattice.mach_number = rate * height / 4 / speed_of_sound;
  }
}

void set_duration(const Problem& problem, LatticeParameters& lattice) {
  const bool rest = problem.flow.kind == FlowKind::rest;
  const auto& duration = problem.run.duration;
  if (rest && !problem.run.steps && !duration) throw InputError("run.steps is missing: flow.kind = \"rest\" needs the length of the run in time steps, a whole number >= 1 (or run.duration)");
  lattice.steps_per_strain = rest ? 0 : 1 / lattice.shear_rate;
  const double unit = !rest ? lattice.steps_per_strain : duration ? lattice.membrane_time : 1;
  const auto steps = [](const char* key, double value, double steps_per_unit) {
    const double n = value * steps_per_unit;
    if (n > 1e15) throw InputError(fmt::format("{} = {} is {:.3g} time steps, more than can be counted (1e15): lower it or raise the shear rate", key, value, n));
    return std::max<std::int64_t>(1, std::llround(n));
  };
  const auto whole = [&](std::int64_t n) { return lattice.next_coupling(n); };
  lattice.coupling_every = problem.cells.empty() ? 1 : problem.accuracy.coupling_every;
  lattice.steps = problem.run.steps ? *problem.run.steps : duration ? steps("run.duration", *duration, lattice.membrane_time) : steps("run.strain", problem.run.strain, unit);
  lattice.steps = whole(lattice.steps);
  lattice.series_every = whole(steps("output.series_every", problem.output.series_every, unit));
  lattice.snapshot_every = problem.output.snapshot_every > 0 ? whole(steps("output.snapshot_every", problem.output.snapshot_every, unit)) : 0;
  // Absent at rest, where there is no strain.
  if (problem.output.checkpoint_strain) lattice.checkpoint_every = whole(steps("output.checkpoint_strain", *problem.output.checkpoint_strain, unit));
  lattice.guard_every = whole(problem.guards.every);
}

}  // namespace

LatticeParameters to_lattice(const Problem& problem) {
  LatticeParameters lattice;
  set_fluid(problem, lattice);
  set_box(problem, lattice);
  set_cells(problem, lattice);
  const double kappa = choose_shear_rate(problem, lattice);
  set_moduli(problem, kappa, lattice);
  if (kappa > 0) lattice.membrane_time = lattice.viscosity * lattice.radius / kappa;
  lattice.si = si_units(problem.si, lattice.radius, kappa, lattice.viscosity);
  set_flow(problem, lattice);
  set_stability_margins(problem, lattice);
  set_duration(problem, lattice);
  return lattice;
}

double relaxation_time_of_fewest_steps(Problem problem) {
  constexpr int largest = 20, smallest = 10;  // tenths
  constexpr double little_compression = 0.05;
  LatticeParameters shape;
  try {
    set_box(problem, shape);
    set_cells(problem, shape);  // shells of TRT don't depend on tau
  } catch (const InputError&) {
    return largest / 10.0;  // to_lattice() will tell
  }
  double best = largest / 10.0, least = std::numeric_limits<double>::infinity();
  for (int tenths = largest; tenths >= smallest; --tenths) {
    problem.accuracy.relaxation_time = tenths / 10.0;
    try {
      LatticeParameters lattice = shape;
      set_fluid(problem, lattice);
      const double kappa = choose_shear_rate(problem, lattice);
      double steps = lattice.shear_rate > 0 ? 1 / lattice.shear_rate : kappa > 0 ? lattice.viscosity * lattice.radius / kappa : 1;
      if (kappa > 0 && lattice.shear_rate > 0) steps = std::max(steps, crowding_density(lattice.phi_effective, lattice.capillary_number, lattice.viscosity, 1) / little_compression);
      if (steps < least * (1 - 1e-9)) {
        least = steps;
        best = problem.accuracy.relaxation_time;
      } else if (std::isfinite(least)) {
        break;  // a limit that rises with tau has taken over from one that falls
      }
    } catch (const InputError&) {  // beyond a limit with this one
    }
  }
  return best;
}

}  // namespace corpuscle
