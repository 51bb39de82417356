// What is stable: the measured limits that scenes are checked against (docs/stability.md; measured by `corpuscle stability`).
#pragma once
#include <array>
#include <string>
#include <vector>

#include "physics/mesh.hpp"
#include "physics/units.hpp"

namespace corpuscle {

/// Fraction of a measured limit up to which settings are chosen by default and accepted silently; up to the limit they are accepted with a warning, beyond it refused.
inline constexpr double stability_margin = 0.8;

/// Largest stable moduli over the viscosity eta_0, as shares of a sum (bending: kappa_B/edge).
struct StiffnessLimits {
  double shear = 0;     ///< kappa_S/eta_0
  double dilation = 0;  ///< kappa_alpha/eta_0
  double bending = 0;   ///< kappa_B/(eta_0 edge), edge in lattice units
  double contact = 0;   ///< kappa_int/eta_0
  /// kappa_S/eta_0 and kappa_alpha/eta_0 by themselves, for meshes of several edges: where shares of a sum would allow more (chebyshev). 0: they don't.
  std::array<double, 5> shear_alone{}, dilation_alone{};
};
/// @param phi_effective effective volume fraction: crowded cells are less stable
StiffnessLimits stiffness_limits(const AccuracySpec& accuracy, double phi_effective);

/// Largest stable response of the volume and the area force (below).
double stable_response(const AccuracySpec& accuracy);
/// That of the area force of a cell's reference shape: neighbours fold cells, and where a cell is folded its curvature, and with it the response, is larger. In red cells sheared at
/// phi_eff = 0.9, Ca = 0.028, r = 4 the mean of (2H)^2 grew to 2.9 times that of the reference, at phi_geo = 0.4, Ca = 0.1, r = 8 to 2.4 times, within some strain units.
inline constexpr double curvature_growth = 3;
inline double stable_area_response(const AccuracySpec& accuracy) { return stable_response(accuracy) / curvature_growth; }

/// Pressure of the fluid between crowded cells over eta_0 gamma_dot: an upper bound of what was measured (docs/stability.md, Compression; `perf/compression.py`).
double crowding_pressure(double phi_effective, double capillary_number);
/// By how much this pressure, c_s^2 = 1/3 times the deviation, makes the density of the fluid differ from 1.
inline double crowding_density(double phi_effective, double capillary_number, double viscosity, double shear_rate) {
  return 3 * viscosity * shear_rate * crowding_pressure(phi_effective, capillary_number);
}

/// Mean edges in lattice units for which limits were measured.
inline constexpr double finest_edge = 0.4, coarsest_edge = 2.5;

/// kappa_alpha of a Skalak membrane with the same resistance to dilation: neo-Hookean K = 3 G, Skalak K = (1 + 2 C) G.
double dilation_stiffness(StrainLawKind law, double shear, double area_dilation);
/// How much of the stable range a membrane uses: shear/limit + dilation/limit + bending/(limit edge), moduli over eta_0; or shear or dilation over its limit
/// alone, if that is more. Stable up to 1: the largest eigenvalue of a sum of
/// stiffness matrices is at most the sum of theirs.
double stiffness_load(const StiffnessLimits& limits, double edge, double shear, double dilation, double bending);

/// Response of the fluid to the global terms in one step. A normal displacement d of the whole surface raises the pressure by kappa_V A d/V_0; the fluid answers like a
/// sound wave, with the velocity p/(2 rho c_s): the response is kappa_V A/(2 c_s V_0). The area term has the pressure kappa_A (2H)^2 d: kappa_A (2H)^2/(2 c_s).
double volume_response(const CellTypeLattice& cell, double modulus);
double area_response(const CellTypeLattice& cell, double modulus);
/// The moduli that have a given response.
double volume_modulus(const CellTypeLattice& cell, double response);
double area_modulus(const CellTypeLattice& cell, double response);

/// Mean over the surface of (2H)^2, H the mean curvature: sum over vertices |dA/dx_v|^2 N/A^2.
double squared_curvature(const Mesh& mesh);
double mean_edge(const Mesh& mesh);

/// What is unstable is refused, or warned of where the scene insists (accuracy.allow_unstable). @throws InputError with the message.
void refuse_unstable(const Problem& problem, LatticeParameters& lattice, const std::string& message);

/// Where a scene stands against all limits, and a warning for each that it comes close to. Needs the moduli and the flow.
/// @throws InputError when the fluid alone is unstable at this Mach number (the moduli were checked when the shear rate was chosen).
void set_stability_margins(const Problem& problem, LatticeParameters& lattice);

}  // namespace corpuscle
