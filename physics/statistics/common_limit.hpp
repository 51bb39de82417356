// The limit of infinite resolution that several series of measurements share: Richardson's extrapolation of each, and their weighted mean.
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

/// value = limit + first/resolution + second/resolution^2, from the resolution `from` on.
struct FamilyLimit {
  Estimate limit;                     ///< its error has both parts below
  double from = not_a_number;
  double first = not_a_number, second = not_a_number;  ///< second is 0 where one term is enough
  double statistical_error = not_a_number;
  double model_error = not_a_number;  ///< change of the limit without the coarsest resolution, and a quarter (half, with one term) of the way from the finest resolution to the limit
};

struct CommonLimit {
  Estimate limit;
  double chi2 = not_a_number;         ///< of the families about their mean
  int degrees_of_freedom = 0;
  std::vector<FamilyLimit> families;
};

/// Least squares for each family with one or two terms in 1/resolution, whichever Akaike's criterion prefers; coarse resolutions, for which the series
/// doesn't hold, are left out one by one until chi2 is below two per degree of freedom (Richardson 1911; Roache, J. Fluids Eng. 116, 1994). The error of a family's limit is the statistical one and
/// the model's, together: the change of the limit when the coarsest resolution is left out, and a quarter of the way from the finest resolution to the limit, half of it with one term (noise can hide that a series bends); so families far from their limit say little. Points count with their errors, and with a hundredth of
/// the family's range where that is more. The limit is the mean of the families, weighted with their errors; its error grows where they scatter more than those allow.
/// A family takes part with three or more resolutions; points whose value or error is not finite are left out. Not converged: no family can be checked, they contradict each other (chi2 above four per degree of
/// freedom), or the error is beyond 5 %.
CommonLimit common_limit(const std::vector<ResolvedValue>& values);

}  // namespace corpuscle::statistics
