#include "physics/stability_limits.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace corpuscle {
namespace {

/// Measured in flow at phi_eff = 0.45, r = 5, edge 1, tau = 1: the largest stable values of `corpuscle stability` (docs/stability.md), and what the limit of a red cell's
/// membrane is at tau = 0.6 and 2, relative to tau = 1. Bending was measured in flow with 3 points; with 2 and 4 it is the limit at rest times the same ratio, 0.6.
struct Row {
  double shear, dilation, bending, contact;
  double at_small_tau, at_large_tau;
  std::array<double, 5> shear_alone{}, dilation_alone{};  ///< at `edges`; 0: the same as in a sum, and at every edge
};
/// Mean edges in lattice units for which single moduli were measured (one cell at rest; edge 1: in flow too).
constexpr std::array<double, 5> edges{0.38, 0.71, 1, 1.67, 2.5};
/// Euler steps with the kernels that see staggered momenta: noise grows at any stiffness, the slower the softer (docs/theory/model.md, Coupling).
bool noise_always_grows(const AccuracySpec& accuracy) { return accuracy.vertex_update == VertexUpdate::euler && accuracy.delta_kernel != 4; }

// A new vertex update needs rows here; until it has them it is held to the limits of `averaged`. For chebyshev the moduli share the limit L of a red cell's membrane
// in equal parts (3 L, 3 L/2.5 ..., at r = 5), and contacts get L; kappa_S and kappa_alpha alone have limits of their own, which fall with fine and with coarse meshes
// (300: the stiffest that was tried; where a cell at rest is less stable than one in flow, it is that;
// on coarse meshes a neo-Hookean capsule in flow: tests/validation/test_stability.cpp).
Row measured(const AccuracySpec& accuracy) {
  if (accuracy.vertex_update == VertexUpdate::euler) {
    switch (accuracy.delta_kernel) {  // 2 and 3 points: a red cell's membrane up to which noise triples in no less than 1000 steps, shared out
      case 2: return {0.06, 0.07, 0.05, 0.1, 1, 1};
      case 3: return {0.2, 0.25, 0.1, 0.2, 1, 0.3};
      default: return {45, 45, 12, 90, 1, 0.32};
    }
  }
  if (accuracy.vertex_update == VertexUpdate::chebyshev) {
    switch (accuracy.delta_kernel) {
      case 2: return {900, 2250, 55, 300, 0.058, 1, {3.36, 10.4, 300, 12, 12}, {2.59, 10.4, 24.7, 38, 38}};
      case 3: return {249, 622, 15.4, 83, 0.16, 1, {8.7, 29.3, 69.8, 28, 12}, {7.3, 90, 300, 76, 32}};
      default: return {161, 403, 10, 53, 0.23, 0.38, {12.3, 29.3, 64, 64, 28}, {38, 98, 300, 300, 64}};
    }
  }
  switch (accuracy.delta_kernel) {
    case 2: return {13.4, 14.6, 0.65, 600, 1.6, 0.29};
    case 3: return {24.6, 22.6, 2.18, 1000, 1.09, 0.22};
    default: return {29.3, 26.9, 4.4, 1000, 1.29, 0.29};
  }
}

/// All limits are those of a coupling at every step. What is coupled every k-th step moves k times as far under the same force, so they are divided by k. Over the k-th part was measured, for
/// a red cell's membrane in flow, 3 points: 1.6, 1.13, 0.95 ... 1.04 (the bracket), 1.04 at k = 2, 3, 4, 8; 2 and 4 points and other tau: 1.1 and more; kappa_V 1.4, kappa_int 1.7 at k = 4.

/// Largest stable response of the volume force in flow at r = 8, tau = 1 and 0.6, with 3 points, averaged. Other radii (r = 5 in flow: 1.7 and 0.77; at rest r = 5, 8, 12: 2.2, 1.5, 1.7),
/// the area force and larger tau have the same or higher limits.
constexpr double response_in_flow = 1.17, response_at_small_tau = 0.58;
/// For chebyshev steps there is none: what is accepted is what was tried.
constexpr double response_tried = 100;

/// Limit of a red cell's membrane (kappa_int = kappa_S) at phi_eff = 0.2, 0.66, 0.88, relative to 0.45; measured for 3 points averaged (2 points: the same assumed) and for 4
/// points. Chebyshev steps: the lower of 3 and 4 points; 5.7 eta_0 at 0.88, hardly above averaged steps.
double fraction_factor(const AccuracySpec& accuracy, double phi_effective) {
  constexpr double phi[] = {0.2, 0.45, 0.66, 0.88}, narrow[] = {1.19, 1, 0.84, 0.54}, wide[] = {1.29, 1, 0.77, 0.50};
  constexpr double wide_euler[] = {1.30, 1, 0.84, 0.46}, chebyshev[] = {1, 1, 0.25, 0.074};
  const double* factor = accuracy.vertex_update == VertexUpdate::chebyshev ? chebyshev
                         : accuracy.delta_kernel != 4                      ? narrow
                         : accuracy.vertex_update == VertexUpdate::euler   ? wide_euler
                                                                           : wide;
  if (phi_effective <= phi[0]) return factor[0];
  for (int i = 1; i < 4; ++i)
    if (phi_effective <= phi[i]) return factor[i - 1] + (factor[i] - factor[i - 1]) * (phi_effective - phi[i - 1]) / (phi[i] - phi[i - 1]);
  return factor[3];
}

// Viscosity factors 3 eta_0 at the relaxation times that were measured: 0.6, 1, 2.
constexpr double small_eta = 0.1, reference_eta = 0.5, large_eta = 1.5;

double power_law(double x, double x0, double y0, double x1, double y1) { return y0 * std::pow(y1 / y0, std::log(x / x0) / std::log(x1 / x0)); }

/// Below tau = 0.6 the limit over eta_0 falls with (tau - 1/2)^0.9: kappa_S = eta_0 is stable down to tau = 0.511 (3 points, TRT; BGK: beyond).
constexpr double small_tau_exponent = 0.9;

/// Above tau = 2 the limits are constant in lattice units with BGK: there inertia sets the limit, not viscosity. With TRT they fall further, with 1/sqrt(eta_0): its odd moments
/// are hardly damped there (capsules at tau = 2, 3, 5: perf/stable_stiffness.py). TRT with 2 points is lower by a quarter at tau = 2 already.
double large_tau_factor(const Row& row, const AccuracySpec& accuracy) {
  const double eta = accuracy.relaxation_time - 0.5;
  if (accuracy.collision == CollisionKind::bgk) return row.at_large_tau * large_eta / eta;
  return row.at_large_tau * std::pow(large_eta / eta, 1.5);
}

/// Between the measured relaxation times the limits over eta_0 change by powers of eta_0.
double tau_factor(const Row& row, const AccuracySpec& accuracy) {
  const double eta = accuracy.relaxation_time - 0.5;
  if (eta <= small_eta) return row.at_small_tau * std::pow(eta / small_eta, small_tau_exponent);
  if (eta <= reference_eta) return power_law(eta, small_eta, row.at_small_tau, reference_eta, 1);
  if (eta <= large_eta) return power_law(eta, reference_eta, 1, large_eta, row.at_large_tau);
  return large_tau_factor(row, accuracy);
}

/// Between the measured edges by a power law, beyond them that of the last interval.
double at_edge(const std::array<double, 5>& limits, double edge) {
  std::size_t i = 0;
  while (i + 2 < edges.size() && edge > edges[i + 1]) ++i;
  return power_law(edge, edges[i], limits[i], edges[i + 1], limits[i + 1]);
}

/// Largest stable Mach number of the walls in plane Couette flow with noise at tau - 1/2 = 0.01, 0.05, 0.1, 0.5.
double mach_limit(CollisionKind collision, double relaxation_time) {
  constexpr double at[] = {0.01, 0.05, 0.1, 0.5}, bgk[] = {0.149, 0.595, 0.707, 1.15}, trt[] = {0.229, 0.648, 0.771, 1.07};
  const double eta = relaxation_time - 0.5;
  const double* limit = collision == CollisionKind::bgk ? bgk : trt;
  if (eta >= at[3]) return limit[3];
  const int i = eta < at[1] ? 0 : eta < at[2] ? 1 : 2;
  return power_law(eta, at[i], limit[i], at[i + 1], limit[i + 1]);
}

}  // namespace

StiffnessLimits stiffness_limits(const AccuracySpec& accuracy, double phi_effective) {
  Row row = measured(accuracy);
  if (accuracy.collision == CollisionKind::trt && accuracy.delta_kernel == 2 && accuracy.vertex_update == VertexUpdate::averaged) row.at_large_tau *= 0.75;
  const double factor = tau_factor(row, accuracy) * fraction_factor(accuracy, phi_effective) / accuracy.coupling_every;
  StiffnessLimits limits{factor * row.shear, factor * row.dilation, factor * row.bending, factor * row.contact, row.shear_alone, row.dilation_alone};
  for (auto* alone : {&limits.shear_alone, &limits.dilation_alone})
    for (double& limit : *alone) limit *= factor;
  return limits;
}

double stable_response(const AccuracySpec& accuracy) {
  if (accuracy.vertex_update == VertexUpdate::chebyshev) return response_tried;
  const double eta = accuracy.relaxation_time - 0.5;  // below tau = 0.6 the power law goes on
  return (eta >= reference_eta ? response_in_flow : power_law(eta, small_eta, response_at_small_tau, reference_eta, response_in_flow)) / accuracy.coupling_every;
}

double dilation_stiffness(StrainLawKind law, double shear, double area_dilation) { return law == StrainLawKind::skalak ? area_dilation : shear; }

double stiffness_load(const StiffnessLimits& limits, double edge, double shear, double dilation, double bending) {
  const double sum = shear / limits.shear + dilation / limits.dilation + bending / (limits.bending * edge);
  if (limits.shear_alone[0] == 0) return sum;
  return std::max({sum, shear / at_edge(limits.shear_alone, edge), dilation / at_edge(limits.dilation_alone, edge)});
}

double crowding_pressure(double phi_effective, double capillary_number) { return 5 + 50 * std::pow(phi_effective, 1.5) * std::pow(capillary_number, -0.4); }

double volume_response(const CellTypeLattice& cell, double modulus) { return modulus * cell.area / (2 * speed_of_sound * cell.volume); }
double area_response(const CellTypeLattice& cell, double modulus) { return modulus * cell.squared_curvature / (2 * speed_of_sound); }
double volume_modulus(const CellTypeLattice& cell, double response) { return response / volume_response(cell, 1); }
double area_modulus(const CellTypeLattice& cell, double response) { return response / area_response(cell, 1); }

double squared_curvature(const Mesh& mesh) {
  std::vector<Vector3> gradient(mesh.vertices.size(), Vector3::Zero());
  for (const auto& face : mesh.faces) {
    const Vector3 &a = mesh.vertices[face[0]], &b = mesh.vertices[face[1]], &c = mesh.vertices[face[2]];
    const Vector3 normal = (b - a).cross(c - a).normalized();
    gradient[face[0]] += 0.5 * normal.cross(c - b);
    gradient[face[1]] += 0.5 * normal.cross(a - c);
    gradient[face[2]] += 0.5 * normal.cross(b - a);
  }
  double sum = 0;
  for (const Vector3& g : gradient) sum += g.squaredNorm();
  return sum * double(mesh.vertices.size()) / std::pow(mesh_area(mesh), 2);
}

double mean_edge(const Mesh& mesh) {
  double sum = 0;
  const auto edges = mesh_edges(mesh);
  for (const MeshEdge& edge : edges) sum += (mesh.vertices[edge.p] - mesh.vertices[edge.q]).norm();
  return sum / double(edges.size());
}

void refuse_unstable(const Problem& problem, LatticeParameters& lattice, const std::string& message) {
  if (!problem.accuracy.allow_unstable) throw InputError(message);
  lattice.warnings.push_back(message + " (accepted, because accuracy.allow_unstable = true)");
}

void set_stability_margins(const Problem& problem, LatticeParameters& lattice) {
  const StiffnessLimits limits = stiffness_limits(problem.accuracy, lattice.phi_effective);
  const double eta = lattice.viscosity;
  const auto add = [&](const std::string& name, double value, double limit, const std::string& way_out) {
    lattice.margins.push_back({name, value, limit});
    if (value > stability_margin * limit * (1 + 1e-8) && value <= limit * (1 + 1e-8))
      lattice.warnings.push_back(fmt::format("{} is at {:.0f} % of its measured stability limit (docs/stability.md): {}", name, 100 * value / limit, way_out));
  };
  if (lattice.mach_number > 0) {
    const double limit = mach_limit(problem.accuracy.collision, lattice.relaxation_time);
    add("Mach number", lattice.mach_number, limit, "lower accuracy.mach_max or raise accuracy.relaxation_time");
    if (lattice.mach_number > limit * (1 + 1e-8)) {
      const std::string message = fmt::format("accuracy.mach_max = {} is unstable with accuracy.relaxation_time = {}: it must be <= {:.3g}; or raise the relaxation time",
                                              problem.accuracy.mach_max, lattice.relaxation_time, 0.999 * limit);
      refuse_unstable(problem, lattice, message);
    }
  }
  if (!lattice.cells.empty() && lattice.shear_rate > 0) {
    const double density = crowding_density(lattice.phi_effective, lattice.capillary_number, eta, lattice.shear_rate);
    const std::string way_out = "lower accuracy.relaxation_time or accuracy.shear_modulus, or give the cells more room";
    add("density of the fluid between cells", density, problem.guards.density, way_out);
    if (density > problem.guards.density * (1 + 1e-8))  // a modulus that the scene fixes: the bound is a cautious one, so that this is no reason to refuse
      lattice.warnings.push_back(fmt::format("Cells may compress the fluid until guards.density = {} ends the run (docs/stability.md, Compression): {}", problem.guards.density, way_out));
  }
  for (std::size_t i = 0; i < lattice.cells.size(); ++i) {
    const CellTypeLattice& cell = lattice.cells[i];
    const MembraneModuli& m = cell.moduli;
    add(fmt::format("membrane stiffness of {}", cell.name), stiffness_load(limits, cell.edge, m.shear / eta, dilation_stiffness(m.law, m.shear, m.area_dilation) / eta, m.bending / eta), 1,
        "lower accuracy.shear_modulus, or let the program choose it");
    if (m.volume > 0) add(fmt::format("volume force of {}", cell.name), volume_response(cell, m.volume), stable_response(problem.accuracy), fmt::format("lower cells.{}.membrane.volume", i));
    if (m.global_area > 0)
      add(fmt::format("area force of {}", cell.name), area_response(cell, m.global_area), stable_area_response(problem.accuracy), fmt::format("lower cells.{}.membrane.global_area", i));
    if (cell.edge < finest_edge * (1 - 1e-3) || cell.edge > coarsest_edge * (1 + 1e-3))
      lattice.warnings.push_back(fmt::format("The mesh of {} has edges of {:.3g} lattice units on average; stability was measured for {} to {} only: change accuracy.subdivision",
                                             cell.name, cell.edge, finest_edge, coarsest_edge));
  }
  if (noise_always_grows(problem.accuracy) && !lattice.cells.empty())
    lattice.warnings.push_back(fmt::format("accuracy.vertex_update = \"euler\" with accuracy.delta_kernel = {} lets velocity noise grow at any stiffness (docs/stability.md): choose "
                                           "\"averaged\", or 4 points", problem.accuracy.delta_kernel));
  if (lattice.contact_strength > 0) add("contact stiffness", lattice.contact_strength / eta, limits.contact, "lower contact.strength");
}

}  // namespace corpuscle
