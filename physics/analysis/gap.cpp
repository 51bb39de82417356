// Gap between the cells from the balance of dissipation.
#include "physics/analysis/flow_curves.hpp"
#include "physics/analysis/groups.hpp"
#include "physics/statistics/dissipation.hpp"

namespace corpuscle::analysis {

void add_gap(const SteadyState& state, Analysis& analysis) {
  std::string missing = state.at_rest();
  if (missing.empty()) missing = state.without_company();
  if (missing.empty()) missing = state.stress_missing;
  if (!missing.empty()) return analysis.refuse(Group::gap, missing);
  // Velocities in shear_rate r: the gap comes out in radii.
  const auto sum = total_variance({analysis.estimate("velocity_variance_x"), analysis.estimate("velocity_variance_y"), analysis.estimate("velocity_variance_z")});
  const auto gap = statistics::gap_size({.volume_fraction = analysis.estimate("phi_bulk").value,
                                         .shear_rate = 1,
                                         .velocity_variance = sum,
                                         .relative_viscosity = analysis.estimate("relative_viscosity")});
  analysis.estimate("gap_size") = gap;
  auto& lattice = analysis.estimate("gap_size_lattice");
  lattice = gap;
  lattice.value *= state.record.radius;
  lattice.error *= state.record.radius;
}

}  // namespace corpuscle::analysis
