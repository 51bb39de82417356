// The limit of infinite resolution that several series of measurements share: Richardson's extrapolation by least squares.
#pragma once
#include <vector>

#include "physics/statistics/estimate.hpp"

namespace corpuscle::statistics {

/// A value measured at a resolution (nodes per radius, for example) with settings that have the same limit as those of the other families.
struct ResolvedValue {
  double resolution = 0;
  int family = 0;      ///< 0, 1, 2 ...
  double value = 0, error = 0;
};

struct CommonLimit {
  Estimate limit;             ///< its error has both parts below
  double from = not_a_number;               ///< the coarsest resolution that was used
  double statistical_error = not_a_number;
  double model_error = not_a_number;  ///< change of the limit without that resolution; NaN where nothing finer determines it
  double chi2 = not_a_number;
  int degrees_of_freedom = 0;
  /// Of each family value = limit + first/resolution + second/resolution^2. NaN for one that took no part.
  struct Terms {
    double first = not_a_number, second = not_a_number;
  };
  std::vector<Terms> terms;
};

/// Least squares with one limit for all families and one term (two where a family has four or more resolutions) for each (Richardson 1911; Roache, J. Fluids Eng. 116,
/// 1994). Points count with their errors, and with a thousandth of their value where that is more: the model is no better. Coarse resolutions, for which the series in 1/resolution
/// doesn't hold, are left out one by one until chi2 is below two per degree of freedom. Where it never is, the statistical error grows with it and the limit isn't converged; nor is
/// it when it can't be confirmed without the coarsest resolution, or changes by more than 5 % then. Points that are not finite, and families with one resolution, are left out.
CommonLimit common_limit(const std::vector<ResolvedValue>& values);

}  // namespace corpuscle::statistics
