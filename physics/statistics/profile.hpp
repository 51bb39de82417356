// Profiles across the gap, and fluctuations about the measured mean flow.
#pragma once
#include "physics/statistics/estimate.hpp"
#include "physics/statistics/resample.hpp"

namespace corpuscle::statistics {

struct ProfileOptions {
  double low = 0, high = 0;     ///< range of z
  Eigen::Index bins = 20;
  Eigen::Index blocks = 16;     ///< stretches of time, the independent samples of the errors
};

/// Mean of a quantity of the cells [times][cells] over those whose height z lies in a bin; x = mid-height. Velocity, stresslet, deformation ...
BlockedCurve profile(const SeriesMatrix& heights, const SeriesMatrix& quantity, const ProfileOptions& options);

/// Sum of a quantity over the cells of a bin per area of the walls and thickness of the bin: `quantity` = the cells' volumes gives the volume fraction by
/// centres, stresslets the local stress. `area`: of a plane z = const.
BlockedCurve density_profile(const SeriesMatrix& heights, const SeriesMatrix& quantity, double area, const ProfileOptions& options);

/// Velocity minus the measured mean flow at each cell's height: `mean_flow` (from `profile` of the same velocities, say) is interpolated linearly between
/// the mid-heights of its bins that have a value, and extrapolated beyond. NaN where no profile of two bins exists. The measured profile follows the
/// cells, so that variances come out smaller by about the share bins/(cells x independent times).
Eigen::MatrixXd fluctuations(const SeriesMatrix& heights, const SeriesMatrix& velocities, const Curve& mean_flow);

/// The same about a uniform shear flow, velocity(z) = shear_rate (z - centre).
Eigen::MatrixXd fluctuations(const SeriesMatrix& heights, const SeriesMatrix& velocities, double shear_rate, double centre);

/// 1 where low <= z <= high at that time, NaN elsewhere: multiplied to a quantity it keeps the bulk only (layers at the walls left out).
Eigen::MatrixXd within(const SeriesMatrix& heights, double low, double high);

}  // namespace corpuscle::statistics
