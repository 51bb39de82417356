#include "physics/units.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "physics/contact_patches.hpp"
#include "physics/hydrodynamic_size.hpp"
#include "physics/mesh.hpp"
#include "physics/stability_limits.hpp"

namespace corpuscle {

namespace {

constexpr double tolerance = 1e-8;         // limits are met to rounding: 1.2/6 isn't 0.2 in binary
constexpr double stiffness_at_rest = 0.25; // kappa_S / eta_0 where no flow sets it: soft, and well inside the limit
constexpr double penalty = 6;              // kappa_A / eta_0: 1 at tau = 1 (docs/theory/model.md, typical values)
constexpr double default_response = 0.5;    // of volume and area forces (physics/stability_limits.hpp), well inside the limits; at most the margin of stability
constexpr double packable = 0.78;          // largest phi that deformable cells reach by growing (docs/theory/model.md: 0.75 is needed)
constexpr double packable_effective = 0.92;
constexpr double most_nodes = 2e9;         // 32-bit node index
constexpr double smallest_box = 4;         // nodes; below it the kernels' halo is wider than the box

/// Rounded to five digits, never beyond `value`: a limit that a message offers must itself be accepted.
std::string at_most(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - 4);
  return fmt::format("{:.5g}", std::floor(value / unit * (1 + tolerance / 2)) * unit);
}
std::string at_least(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - 4);
  return fmt::format("{:.5g}", std::ceil(value / unit * (1 - tolerance / 2)) * unit);
}

void set_fluid(const Problem& problem, LatticeParameters& lattice) {
  const double tau = problem.accuracy.relaxation_time;
  if (!(tau >= 0.505 && tau <= 5)) {
    throw InputError(fmt::format("accuracy.relaxation_time = {} must be a number >= 0.505 (below it the fluid is unstable) and <= 5 (above it inaccurate); the nearest allowed value is {}",
                                 tau, tau > 5 ? 5 : 0.505));
  }
  lattice.radius = problem.accuracy.radius;
  lattice.relaxation_time = tau;
  lattice.viscosity = (tau - 0.5) / 3;
}

void set_box(const Problem& problem, LatticeParameters& lattice) {
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
  if (diameter * radius > patches.largest_diameter * (1 - tolerance)) refuse("makes both patches overlap", "< " + at_most(patches.largest_diameter / radius));
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
  double vertices = 0, one = 0;
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
    cell.effective_volume = mesh_effective_volume(mesh, cell.shell_thickness);
    cell.count = count_of(spec, i, cell, box);
    lattice.phi_geometric += static_cast<double>(cell.count) * cell.volume / box;
    lattice.phi_nominal += static_cast<double>(cell.count) * cell.nominal_volume / box;
    lattice.phi_effective += static_cast<double>(cell.count) * cell.effective_volume / box;
    vertices += static_cast<double>(cell.count * cell.vertices);
    one = std::max(one, cell.effective_volume / box);
    lattice.cells.push_back(cell);
  }
  // A fraction at the limit may round up by half a cell.
  const double excess = std::max((lattice.phi_geometric - one / 2) / packable, (lattice.phi_effective - one / 2) / packable_effective);
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
    throw InputError(fmt::format("{} fills the box to phi = {:.4g}, phi_effective = {:.4g}, which can't be packed: at most {} and {} are allowed; lower it or enlarge the box", keys,
                                 lattice.phi_geometric, lattice.phi_effective, packable, packable_effective));
  }
  if (vertices > std::numeric_limits<std::int32_t>::max()) {
    throw InputError(fmt::format("the cells have {:.3g} vertices in all, but at most {} are supported: lower the number of cells or accuracy.subdivision", vertices,
                                 std::numeric_limits<std::int32_t>::max()));
  }
}

/// Chooses kappa_S and the shear rate together: the capillary number ties one to the other, every limit bounds both. By default stability is used up to `stability_margin`;
/// values that the scene fixes are refused beyond the measured limits only.
class ShearRateChoice {
 public:
  ShearRateChoice(const Problem& problem, LatticeParameters& lattice) : p_(problem), l_(lattice) {
    if (p_.flow.capillary_number) ca_ = *p_.flow.capillary_number;
    else if (p_.flow.capillary_number_G) ca_ = *p_.flow.capillary_number_G / 3;
    for (std::size_t i = 0; i < p_.cells.size(); ++i) modulus_.push_back(moduli_limits(i));
  }

  /// Returns kappa_S of the scene; 0 without cells.
  double choose() {
    const bool cells = !p_.cells.empty();
    const double eta = l_.viscosity;
    double kappa = cells ? p_.accuracy.shear_modulus.value_or(0) : 0;
    if (kappa > 0) check_modulus(kappa);
    if (p_.flow.kind == FlowKind::rest) {
      return !cells || kappa > 0 ? kappa : std::min(stiffness_at_rest * eta, stability_margin * largest_modulus());
    }
    velocity_per_rate_ = l_.nodes[2] / (p_.flow.kind == FlowKind::shear ? 2.0 : 4.0);  // wall speed; centre-line speed gamma_w H/4
    add("reynolds_number_max", p_.flow.reynolds_number_max * eta / (l_.radius * l_.radius));
    add("mach_max", p_.accuracy.mach_max * speed_of_sound / velocity_per_rate_);
    if (cells && kappa > 0 && p_.accuracy.shear_rate) {
      ca_ = eta * *p_.accuracy.shear_rate * l_.radius / kappa;  // both fixed: they state the capillary number
    } else if (cells) {
      if (!(ca_ > 0)) throw InputError("flow.capillary_number is missing: cells in a flow need it, a number > 0 such as 0.081 (or flow.capillary_number_G)");
      const double rate_per_modulus = ca_ / (eta * l_.radius);
      for (const auto& [name, modulus] : smallest_limits()) add_stability(name, rate_per_modulus * modulus);
      if (kappa > 0) fixed("shear_modulus", kappa, rate_per_modulus * kappa);
    }
    if (p_.accuracy.shear_rate) fixed("shear_rate", *p_.accuracy.shear_rate, *p_.accuracy.shear_rate);
    std::stable_sort(l_.limits.begin(), l_.limits.end(), [](const auto& a, const auto& b) { return a.shear_rate < b.shear_rate; });
    if (!fixed_by_.empty()) {  // it may exceed the next limit by rounding, or lie in the margin of stability
      std::stable_partition(l_.limits.begin(), l_.limits.end(), [&](const auto& limit) { return limit.name == fixed_by_; });
    }
    l_.shear_rate = l_.limits.front().shear_rate;
    if (!cells) return 0;
    if (!(kappa > 0)) kappa = eta * l_.shear_rate * l_.radius / ca_;
    l_.capillary_number = ca_;
    return kappa;
  }

 private:
  /// Largest stable kappa_S of the scene as a part of a cell type bounds it; infinite where that part doesn't depend on kappa_S.
  struct ModulusLimit {
    double membrane, volume, area, contact;
  };

  void add(const char* name, double rate) {
    l_.limits.push_back({name, rate});
    hard_.push_back({name, rate});
  }
  /// A stability limit is used up to its margin, but refuses only what is beyond it.
  void add_stability(const char* name, double rate) {
    l_.limits.push_back({name, stability_margin * rate});
    stability_.push_back({name, rate});
  }

  double load_per_modulus(std::size_t i) const {
    const CellSpec& spec = p_.cells[i];
    const double relative = spec.relative_stiffness / l_.viscosity;
    return stiffness_load(stiffness_, l_.cells[i].edge, relative, relative * dilation_ratio(spec), relative * bending_ratio(i));
  }
  static double dilation_ratio(const CellSpec& spec) { return spec.membrane.law == StrainLawKind::skalak ? spec.membrane.area_dilation : 0; }
  double bending_ratio(std::size_t i) const { return p_.cells[i].membrane.bending * l_.cells[i].radius * l_.cells[i].radius; }

  ModulusLimit moduli_limits(std::size_t i) const {
    const CellSpec& spec = p_.cells[i];
    const CellTypeLattice& cell = l_.cells[i];
    const double none = std::numeric_limits<double>::infinity();
    const double volume = spec.membrane.volume.value_or(0) * spec.relative_stiffness / cell.radius, area = spec.membrane.global_area.value_or(0) * spec.relative_stiffness;
    return {1 / load_per_modulus(i), volume > 0 ? volume_modulus(cell, stable_response(p_.accuracy)) / volume : none, area > 0 ? area_modulus(cell, stable_response(p_.accuracy)) / area : none,
            p_.contact.enabled ? stiffness_.contact * l_.viscosity / p_.contact.strength : none};
  }

  /// The smallest of each kind, where there is one.
  std::vector<std::pair<const char*, double>> smallest_limits() const {
    std::vector<std::pair<const char*, double>> limits;
    const std::pair<const char*, double ModulusLimit::*> kinds[] = {{"membrane stability", &ModulusLimit::membrane}, {"volume stability", &ModulusLimit::volume},
                                                                    {"area stability", &ModulusLimit::area}, {"contact stability", &ModulusLimit::contact}};
    for (const auto& [name, member] : kinds) {
      double least = std::numeric_limits<double>::infinity();
      for (const ModulusLimit& limit : modulus_) least = std::min(least, limit.*member);
      if (std::isfinite(least)) limits.emplace_back(name, least);
    }
    return limits;
  }
  double largest_modulus() const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& limit : smallest_limits()) least = std::min(least, limit.second);
    return least;
  }

  void check_modulus(double kappa) {
    const double allowed = kappa * (1 - tolerance);
    const auto too_stiff = [&](const std::string& key, double value, double largest, const char* instead) {
      refuse_unstable(p_, l_, fmt::format("{} = {} is unstable with accuracy.shear_modulus = {}: it must be <= {}; {}", key, value, kappa, at_most(largest), instead));
    };
    for (std::size_t i = 0; i < p_.cells.size(); ++i) {
      const CellSpec& spec = p_.cells[i];
      const std::string at = fmt::format("cells.{}.membrane.", i);
      const ModulusLimit& limit = modulus_[i];
      if (allowed > limit.membrane) {
        // Which modulus to lower: the one with the largest share, if the others leave room for it.
        const double relative = kappa * spec.relative_stiffness / l_.viscosity, edge = l_.cells[i].edge;
        const double shear = stiffness_load(stiffness_, edge, relative, 0, 0), dilation = stiffness_load(stiffness_, edge, 0, relative * dilation_ratio(spec), 0);
        const double bending = stiffness_load(stiffness_, edge, 0, 0, relative * bending_ratio(i));
        if (dilation > std::max(shear, bending) && shear + bending < 1)
          too_stiff(at + "area_dilation", spec.membrane.area_dilation, spec.membrane.area_dilation * (1 - shear - bending) / dilation, "or lower the modulus");
        else if (bending > std::max(shear, dilation) && shear + dilation < 1)
          too_stiff(at + "bending", spec.membrane.bending, spec.membrane.bending * (1 - shear - dilation) / bending, "or lower the modulus");
        else
          refuse_unstable(p_, l_, fmt::format("accuracy.shear_modulus = {} is unstable with accuracy.relaxation_time = {}{}: it must be <= {}", kappa, l_.relaxation_time,
                                              spec.relative_stiffness != 1 ? fmt::format(" and cells.{}.relative_stiffness = {}", i, spec.relative_stiffness) : "",
                                              at_most(limit.membrane)));
      }
      if (allowed > limit.volume) too_stiff(at + "volume", *spec.membrane.volume, *spec.membrane.volume * limit.volume / kappa, "or leave it out for a stable default");
      if (allowed > limit.area) too_stiff(at + "global_area", *spec.membrane.global_area, *spec.membrane.global_area * limit.area / kappa, "or leave it out for a stable default");
    }
    if (!modulus_.empty() && allowed > modulus_[0].contact) too_stiff("contact.strength", p_.contact.strength, p_.contact.strength * modulus_[0].contact / kappa, "or lower the modulus");
  }

  /// A key of [accuracy] fixes the rate: it becomes the deciding limit, unless another limit is lower, which is an error.
  void fixed(const char* key, double value, double rate) {
    const auto lowest = *std::min_element(hard_.begin(), hard_.end(), [](const auto& a, const auto& b) { return a.shear_rate < b.shear_rate; });
    const auto too_fast = [&](const ShearRateLimit& limit, const std::string& way_out) {
      return fmt::format("accuracy.{} = {} gives the shear rate {:.4g}, above the largest that {} allows ({:.4g}): it must be <= {}{}", key, value, rate, limit.name,
                         limit.shear_rate, at_most(value * limit.shear_rate / rate), way_out);
    };
    if (rate > lowest.shear_rate * (1 + tolerance)) {
      std::string way_out;
      if (lowest.name == "reynolds_number_max") way_out = "; or raise flow.reynolds_number_max to " + at_least(p_.flow.reynolds_number_max * rate / lowest.shear_rate);
      const double mach = rate * velocity_per_rate_ / speed_of_sound;
      if (lowest.name == "mach_max" && mach <= 0.3) way_out = "; or raise accuracy.mach_max to " + at_least(mach);
      throw InputError(too_fast(lowest, way_out));
    }
    if (!p_.accuracy.shear_modulus) {  // else check_modulus has told
      for (const ShearRateLimit& limit : stability_)
        if (rate > limit.shear_rate * (1 + tolerance)) refuse_unstable(p_, l_, too_fast(limit, ""));
    }
    l_.limits.push_back({key, rate});
    fixed_by_ = key;
  }

  const Problem& p_;
  LatticeParameters& l_;
  StiffnessLimits stiffness_ = stiffness_limits(p_.accuracy, l_.phi_effective);
  std::vector<ModulusLimit> modulus_;  // of each cell type
  double ca_ = 0;
  std::vector<ShearRateLimit> hard_, stability_;  // what may not be exceeded; what may be with accuracy.allow_unstable
  double velocity_per_rate_ = 0;
  std::string fixed_by_;  // key of [accuracy] that fixes the rate
};

void set_moduli(const Problem& problem, double kappa, LatticeParameters& lattice) {
  for (std::size_t i = 0; i < problem.cells.size(); ++i) {
    const MembraneSpec& spec = problem.cells[i].membrane;
    CellTypeLattice& cell = lattice.cells[i];
    const double response = std::min(default_response, stability_margin * stable_response(problem.accuracy));
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
    m.global_area = spec.global_area ? *spec.global_area * m.shear : keeps_area ? std::max(std::min(penalty * lattice.viscosity, area_modulus(cell, response)), followed * m.shear) : 0;
    m.volume = spec.volume ? *spec.volume * m.shear / cell.radius : std::max(volume_modulus(cell, response), followed * m.shear);
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
  lattice.steps = problem.run.steps ? *problem.run.steps : duration ? steps("run.duration", *duration, lattice.membrane_time) : steps("run.strain", problem.run.strain, unit);
  lattice.series_every = steps("output.series_every", problem.output.series_every, unit);
  lattice.snapshot_every = problem.output.snapshot_every > 0 ? steps("output.snapshot_every", problem.output.snapshot_every, unit) : 0;
}

}  // namespace

LatticeParameters to_lattice(const Problem& problem) {
  LatticeParameters lattice;
  set_fluid(problem, lattice);
  set_box(problem, lattice);
  set_cells(problem, lattice);
  const double kappa = ShearRateChoice(problem, lattice).choose();
  set_moduli(problem, kappa, lattice);
  if (kappa > 0) lattice.membrane_time = lattice.viscosity * lattice.radius / kappa;
  lattice.si = si_units(problem.si, lattice.radius, kappa, lattice.viscosity);
  set_flow(problem, lattice);
  set_stability_margins(problem, lattice);
  set_duration(problem, lattice);
  return lattice;
}

}  // namespace corpuscle
