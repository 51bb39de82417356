// Gap between cells from the balance of dissipation (Gross, Krüger & Varnik, EPL 2014).
#pragma once
#include <string>
#include <vector>

#include "physics/statistics/estimate.hpp"
#include "physics/statistics/fit.hpp"

namespace corpuscle::statistics {

/// What the balance needs of one state; lengths, times and viscosities in any consistent units.
struct DissipationState {
  double volume_fraction = 0;
  double shear_rate = 0;
  Estimate velocity_variance;   ///< sum over x, y, z of <du_a^2>
  Estimate relative_viscosity;  ///< eta/eta_0
};

/// l from sum_a <du_a^2>/shear_rate^2 = [(eta/eta_0 - 1)/(1 - phi) - 1] l^2, errors propagated as independent. NaN, with the reason, where the bracket
/// isn't positive: without particle stress beyond that of the displaced fluid there is no gap to speak of.
Estimate gap_size(const DissipationState& state);

/// 2 (phi^(-1/3) - 1): the gap in units of r' between bodies of radius r' on a lattice.
double gap_in_radii(double volume_fraction);

/// r' of l = 2 r' (phi^(-1/3) - 1), a proportional fit over the states with volume fraction >= `from` whose gap is known. "slope" is r'. States' errors
/// weight them when all have one.
Fit fit_gap_radius(const std::vector<DissipationState>& states, double from = 0.2);

}  // namespace corpuscle::statistics
