// What the runs of a sweep tell together: viscosity against capillary number at each volume fraction, where a yield stress appears, the gap between cells.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "physics/statistics/estimate.hpp"
#include "physics/statistics/fit.hpp"

namespace corpuscle::analysis {

/// What is taken from the analysis of one run.
struct RunOutcome {
  std::string directory;
  double capillary_number = 0, phi_effective = 0, phi_geometric = 0;
  double radius = 0;                       ///< lattice units
  double phi_bulk = statistics::not_a_number;
  statistics::Estimate viscosity;          ///< relative, of the bulk
  statistics::Estimate velocity_variance;  ///< sum over x, y, z, in (shear_rate r)^2
};

/// Runs of one volume fraction, by rising capillary number.
struct FlowCurve {
  double phi_effective = 0, phi_geometric = 0;  ///< means over the runs
  std::vector<std::string> runs;
  statistics::Fit shear_thinning;  ///< prefactor Ca^-exponent, from 3 points on
  statistics::Fit yield_stress;    ///< yield_stress/Ca + prefactor Ca^-exponent, from 4 points on; the stress in kappa_S/r
};

/// Runs whose effective volume fractions differ by less than 2 % of it count as one: whole numbers of cells and the lattice round it.
std::vector<FlowCurve> flow_curves(std::vector<RunOutcome> runs);

/// phi_c at which the yield stress vanishes: zero of the straight line through those that are larger than two of their errors, which weight them. Error from
/// the covariance of the line. NaN with fewer than two such fractions, or when the stress doesn't grow; not converged with two, or when the line is doubtful.
statistics::Estimate critical_volume_fraction(const std::vector<FlowCurve>& curves);

/// r' of l = 2 r' (phi^(-1/3) - 1) over the runs with phi_bulk >= 0.2, in lattice spacings ("slope").
statistics::Fit gap_radius(const std::vector<RunOutcome>& runs);

/// Sum of the variances along x, y, z. They fluctuate together: errors are added, not their squares.
statistics::Estimate total_variance(const std::array<statistics::Estimate, 3>& parts);

}  // namespace corpuscle::analysis
