// Which models a scene can do without: by what leaving them out changed in pairs of simulations (docs/models.md).
#pragma once
#include <string>
#include <vector>

#include "physics/problem.hpp"
#include "physics/units.hpp"

namespace corpuscle {

/// A model that hardly changes the results of a scene. Each alone: what leaving out two at once does was not measured.
struct DispensableModel {
  std::string model;               ///< "contact"
  std::string left_out_by;         ///< "contact.enabled=false", as --set takes it
  double viscosity_change = 0;     ///< of relative viscosity - 1, in parts of it: at most, two standard errors included
  double deformation_change = 0;   ///< of the mean deformation D, likewise
  double saved = 0;                ///< about this share of the time of a step
  std::string measured;            ///< the pairs of runs that surround the scene: "red cells, phi_eff = 0.1 to 0.2, Ca = 0.01 to 0.08, r = 5 and 8"
};

/// What counts as no matter.
inline constexpr double negligible_viscosity_change = 0.02, negligible_deformation_change = 0.01;

/// Only for scenes inside of what was measured: sheared between walls, one type of red cells or spheres with the default membrane, kernel and contact force;
/// resolution, phi_eff and Ca between those of pairs of runs that all had no effect worth more than the above.
/// @param vertex_share of the time of a step that vertices take (membranes, contacts, coupling), the rest being the fluid's
std::vector<DispensableModel> dispensable_models(const Problem& problem, const LatticeParameters& lattice, double vertex_share);

}  // namespace corpuscle
