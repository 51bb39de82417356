#include "physics/units.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "physics/mesh.hpp"

namespace corpuscle {

namespace {

const double speed_of_sound = 1 / std::sqrt(3.0);
constexpr double tolerance = 1e-8;         // limits are met to rounding: 1.2/6 isn't 0.2 in binary
constexpr double stiffness_at_rest = 0.25; // kappa_S / eta_0 where no flow sets it: soft, and well inside the limit
constexpr double penalty = 6;              // kappa_A / eta_0: 1 at tau = 1 (docs/theory/model.md, typical values)
// A cell that breathes pushes sound waves: the pressure of a normal displacement d is kappa_V A d/V_0, the fluid answers with the velocity p/(2 rho c_s), so a step is stable
// only for kappa_V A/(2 c_s V_0) well below 1. Measured at phi_eff = 0.45, averaged update: 0.8 is stable, 1.1 is not.
constexpr double stable_volume = 0.8, default_volume = 0.5;
constexpr double packable = 0.78;          // largest phi that deformable cells reach by growing (docs/theory/model.md: 0.75 is needed)
constexpr double packable_effective = 0.92;
constexpr double most_nodes = 2e9;         // 32-bit node index
constexpr double smallest_box = 4;         // nodes; below it the kernels' halo is wider than the box

/// Largest kappa_S and kappa_alpha over eta_0 that stay stable in a dense suspension (phi_eff = 0.45, perf/stability_dense.sh; 1.2 is an
/// estimate, docs/theory/model.md). With the Euler update the kernels that see staggered momenta (2 and 3 points) allow much less.
struct StiffnessLimits {
  double shear, dilation;
};
StiffnessLimits stiffness_limits(const AccuracySpec& accuracy) {
    if (accuracy.vertex_update == VertexUpdate::averaged) return {1.2, 6};
  switch (accuracy.delta_kernel) {
    case 2: return {0.1, 0.1};
    case 3: return {0.6, 0.6};
    default: return {1.2, 4};
  }
}

/// kappa_V for which kappa_V A/(2 c_s V_0) has the given value.
double volume_modulus(const CellTypeLattice& cell, double response) { return response * 2 * speed_of_sound * cell.volume / cell.area; }

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

Mesh mesh_of(const CellSpec& spec, std::size_t type, double radius, int subdivision) {
  try {
    return make_mesh(spec, radius, subdivision);
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

/// Number of cells from the fraction that the scene gives.
std::int64_t count_of(const CellSpec& spec, std::size_t type, const CellTypeLattice& cell, double box) {
  if (spec.count) return *spec.count;
  if (!spec.volume_fraction && !spec.effective_volume_fraction) {
    throw InputError(fmt::format("cells.{}.count is missing: each cell type needs one of count, volume_fraction, effective_volume_fraction", type));
  }
  const bool geometric = spec.volume_fraction.has_value();
  const double fraction = geometric ? *spec.volume_fraction : *spec.effective_volume_fraction;
  const double one = (geometric ? cell.volume : cell.effective_volume) / box;
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
    const Mesh mesh = mesh_of(spec, i, cell.radius, subdivision);
    check_walls(problem, i, mesh);
    cell.subdivision = spec.shape == ShapeKind::file ? 0 : subdivision;
    cell.vertices = static_cast<std::int64_t>(mesh.vertices.size());
    cell.faces = static_cast<std::int64_t>(mesh.faces.size());
    cell.volume = mesh_volume(mesh);
    cell.area = mesh_area(mesh);
    cell.effective_volume = mesh_effective_volume(mesh, problem.accuracy.shell_thickness);
    cell.count = count_of(spec, i, cell, box);
    lattice.phi_geometric += static_cast<double>(cell.count) * cell.volume / box;
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

/// Chooses kappa_S and the shear rate together: the capillary number ties one to the other, every limit bounds both.
class ShearRateChoice {
 public:
  ShearRateChoice(const Problem& problem, LatticeParameters& lattice) : p_(problem), l_(lattice) {
    if (p_.flow.capillary_number) ca_ = *p_.flow.capillary_number;
    else if (p_.flow.capillary_number_G) ca_ = *p_.flow.capillary_number_G / 3;
    for (const CellSpec& spec : p_.cells) {
      stiffest_ = std::max(stiffest_, spec.relative_stiffness);
      if (spec.membrane.law == StrainLawKind::skalak) dilation_ = std::max(dilation_, spec.relative_stiffness * spec.membrane.area_dilation);
    }
    for (std::size_t i = 0; i < p_.cells.size(); ++i) {
      if (p_.cells[i].membrane.volume.value_or(0) > 0) modulus_by_volume_ = std::min(modulus_by_volume_, largest_modulus_by_volume(i));
    }
  }

  /// Returns kappa_S of the scene; 0 without cells.
  double choose() {
    const bool cells = !p_.cells.empty();
    const double eta = l_.viscosity;
    double kappa = cells ? p_.accuracy.shear_modulus.value_or(0) : 0;
    if (kappa > 0) check_modulus(kappa);
    if (p_.flow.kind == FlowKind::rest) {
      return !cells || kappa > 0 ? kappa : std::min(stiffness_at_rest * eta, largest_modulus());
    }
    velocity_per_rate_ = l_.nodes[2] / (p_.flow.kind == FlowKind::shear ? 2.0 : 4.0);  // wall speed; centre-line speed gamma_w H/4
    add("reynolds_number_max", p_.flow.reynolds_number_max * eta / (l_.radius * l_.radius));
    add("mach_max", p_.accuracy.mach_max * speed_of_sound / velocity_per_rate_);
    if (cells && kappa > 0 && p_.accuracy.shear_rate) {
      ca_ = eta * *p_.accuracy.shear_rate * l_.radius / kappa;  // both fixed: they state the capillary number
    } else if (cells) {
      if (!(ca_ > 0)) throw InputError("flow.capillary_number is missing: cells in a flow need it, a number > 0 such as 0.081 (or flow.capillary_number_G)");
      const double rate_per_modulus = ca_ / (eta * l_.radius);
      add("membrane stability", rate_per_modulus * limits_.shear * eta / stiffest_);
      if (dilation_ > 0) add("area dilation stability", rate_per_modulus * limits_.dilation * eta / dilation_);
      if (std::isfinite(modulus_by_volume_)) add("volume stability", rate_per_modulus * modulus_by_volume_);
      if (kappa > 0) fixed("shear_modulus", kappa, rate_per_modulus * kappa);
    }
    if (p_.accuracy.shear_rate) fixed("shear_rate", *p_.accuracy.shear_rate, *p_.accuracy.shear_rate);
    std::stable_sort(l_.limits.begin(), l_.limits.end(), [](const auto& a, const auto& b) { return a.shear_rate < b.shear_rate; });
    if (!fixed_by_.empty()) {  // it may exceed the next limit by rounding
      std::stable_partition(l_.limits.begin(), l_.limits.end(), [&](const auto& limit) { return limit.name == fixed_by_; });
    }
    l_.shear_rate = l_.limits.front().shear_rate;
    if (!cells) return 0;
    if (!(kappa > 0)) kappa = eta * l_.shear_rate * l_.radius / ca_;
    l_.capillary_number = ca_;
    return kappa;
  }

 private:
  void add(const char* name, double rate) { l_.limits.push_back({name, rate}); }

  double largest_modulus() const {
    const double shear = std::min(limits_.shear * l_.viscosity / stiffest_, modulus_by_volume_);
    return dilation_ > 0 ? std::min(shear, limits_.dilation * l_.viscosity / dilation_) : shear;
  }

  /// Largest kappa_S of the scene for which the volume force that type i asks for is stable.
  double largest_modulus_by_volume(std::size_t i) const {
    const CellTypeLattice& cell = l_.cells[i];
    if (p_.accuracy.vertex_update == VertexUpdate::chebyshev) return std::numeric_limits<double>::infinity();
    return volume_modulus(cell, stable_volume) * cell.radius / (*p_.cells[i].membrane.volume * p_.cells[i].relative_stiffness);
  }

  void check_modulus(double kappa) const {
    const double shear = limits_.shear * l_.viscosity / stiffest_;
    if (kappa > shear * (1 + tolerance)) {
      throw InputError(fmt::format("accuracy.shear_modulus = {} is unstable with accuracy.relaxation_time = {}{}: it must be <= {}", kappa, l_.relaxation_time,
                                   stiffest_ != 1 ? fmt::format(" and relative_stiffness = {}", stiffest_) : "", at_most(shear)));
    }
    for (std::size_t i = 0; i < p_.cells.size(); ++i) {
      const CellSpec& spec = p_.cells[i];
      if (spec.membrane.volume.value_or(0) > 0 && kappa > largest_modulus_by_volume(i) * (1 + tolerance)) {
        throw InputError(fmt::format("cells.{}.membrane.volume = {} is unstable with accuracy.shear_modulus = {}: it must be <= {}; or leave it out for a stable default", i,
                                     *spec.membrane.volume, kappa, at_most(*spec.membrane.volume * largest_modulus_by_volume(i) / kappa)));
      }
      if (spec.membrane.law != StrainLawKind::skalak) continue;
      const double dilation = limits_.dilation * l_.viscosity / (kappa * spec.relative_stiffness);
      if (spec.membrane.area_dilation > dilation * (1 + tolerance)) {
        throw InputError(fmt::format("cells.{}.membrane.area_dilation = {} is unstable with accuracy.shear_modulus = {}: it must be <= {}; or lower the modulus", i,
                                     spec.membrane.area_dilation, kappa, at_most(dilation)));
      }
    }
  }

  /// A key of [accuracy] fixes the rate: it becomes the deciding limit, unless another limit is lower, which is an error.
  void fixed(const char* key, double value, double rate) {
    const auto lowest = *std::min_element(l_.limits.begin(), l_.limits.end(), [](const auto& a, const auto& b) { return a.shear_rate < b.shear_rate; });
    if (rate > lowest.shear_rate * (1 + tolerance)) {
      std::string way_out;
      if (lowest.name == "reynolds_number_max") way_out = "; or raise flow.reynolds_number_max to " + at_least(p_.flow.reynolds_number_max * rate / lowest.shear_rate);
      const double mach = rate * velocity_per_rate_ / speed_of_sound;
      if (lowest.name == "area dilation stability") {
        way_out = fmt::format("; or lower area_dilation (kappa_alpha/kappa_S = {} of the stiffest type) to {}", dilation_, at_most(dilation_ * lowest.shear_rate / rate));
      }
      if (lowest.name == "mach_max" && mach <= 0.3) way_out = "; or raise accuracy.mach_max to " + at_least(mach);
      throw InputError(fmt::format("accuracy.{} = {} gives the shear rate {:.4g}, above the largest that {} allows ({:.4g}): it must be <= {}{}", key, value, rate, lowest.name,
                                   lowest.shear_rate, at_most(value * lowest.shear_rate / rate), way_out));
    }
    add(key, rate);
    fixed_by_ = key;
  }

  const Problem& p_;
  LatticeParameters& l_;
  StiffnessLimits limits_ = stiffness_limits(p_.accuracy);
  double ca_ = 0;
  double stiffest_ = 0;  // largest relative stiffness
  double dilation_ = 0;  // largest kappa_alpha / kappa_S of the scene
  double modulus_by_volume_ = std::numeric_limits<double>::infinity();  // kappa_S that the stiffest given volume force allows
  double velocity_per_rate_ = 0;
  std::string fixed_by_;  // key of [accuracy] that fixes the rate
};

void set_moduli(const Problem& problem, double kappa, LatticeParameters& lattice) {
  for (std::size_t i = 0; i < problem.cells.size(); ++i) {
    const MembraneSpec& spec = problem.cells[i].membrane;
    CellTypeLattice& cell = lattice.cells[i];
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
    m.global_area = spec.global_area ? *spec.global_area * m.shear : keeps_area ? std::max(penalty * lattice.viscosity, followed * m.shear) : 0;
    m.volume = spec.volume ? *spec.volume * m.shear / cell.radius : std::max(volume_modulus(cell, default_volume), followed * m.shear);
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
  if (rest && !problem.run.steps) throw InputError("run.steps is missing: flow.kind = \"rest\" needs the length of the run in time steps, a whole number >= 1");
  lattice.steps_per_strain = rest ? 0 : 1 / lattice.shear_rate;
  const double unit = rest ? 1 : lattice.steps_per_strain;
  const auto steps = [&](const char* key, double value) {
    if (value * unit > 1e15) throw InputError(fmt::format("{} = {} is {:.3g} time steps, more than can be counted (1e15): lower it or raise the shear rate", key, value, value * unit));
    return std::max<std::int64_t>(1, std::llround(value * unit));
  };
  lattice.steps = problem.run.steps ? *problem.run.steps : steps("run.strain", problem.run.strain);
  lattice.series_every = steps("output.series_every", problem.output.series_every);
  lattice.snapshot_every = problem.output.snapshot_every > 0 ? steps("output.snapshot_every", problem.output.snapshot_every) : 0;
}

}  // namespace

LatticeParameters to_lattice(const Problem& problem) {
  LatticeParameters lattice;
  set_fluid(problem, lattice);
  set_box(problem, lattice);
  set_cells(problem, lattice);
  const double kappa = ShearRateChoice(problem, lattice).choose();
  set_moduli(problem, kappa, lattice);
  set_flow(problem, lattice);
  set_duration(problem, lattice);
  return lattice;
}

}  // namespace corpuscle
