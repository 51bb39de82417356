// Least-squares fits by Levenberg-Marquardt (Eigen's port of MINPACK) with covariance, and the models of the figures.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "physics/statistics/estimate.hpp"
#include "physics/statistics/resample.hpp"

namespace corpuscle::statistics {

struct Fit {
  std::vector<std::string> names{};
  Eigen::VectorXd parameters{}, errors{};  ///< NaN where the fit failed
  Eigen::MatrixXd covariance{};
  double chi2 = not_a_number;          ///< sum of the squared residuals over the points' errors (relative residuals where no errors were given)
  int degrees_of_freedom = 0;
  double probability = not_a_number;   ///< of a larger chi2 if the model holds and the points' errors are independent; NaN without errors
  bool converged = false;              ///< the minimum was found and the data determine every parameter
  std::string reason{};

  /// One parameter as an estimate; NaN with a reason for a name that the model lacks.
  Estimate parameter(const std::string& name) const;
};

/// Points to be fitted. Those with NaN, or with an error that is not positive, are left out. Without errors every point gets the same relative error
/// (`relative`) or the same absolute one, which is then estimated from the scatter: the covariance is multiplied by chi2/degrees of freedom.
struct FitData {
  Eigen::VectorXd x, y, error;  ///< `error` of size 0: unknown
  bool relative = false;
};

using Residuals = std::function<Eigen::VectorXd(const Eigen::VectorXd& parameters)>;

struct FitProblem {
  std::vector<std::string> names;
  Eigen::VectorXd start;
  std::vector<bool> positive{};  ///< parameters that are searched as logarithms; empty: none
  bool scale_covariance = false; ///< residuals are in unknown units
};

/// Minimises sum residuals^2; covariance (J^T J)^-1 (Press et al., Numerical Recipes, ch. 15).
Fit least_squares(const Residuals& residuals, const FitProblem& problem);

using Model = std::function<double(double x, const Eigen::VectorXd& parameters)>;
Fit fit_model(const Model& model, const FitData& data, FitProblem problem);

/// y = intercept + slope x, or slope x; by linear algebra.
Fit fit_line(const FitData& data);
Fit fit_proportional(const FitData& data);

/// y = prefactor x^exponent: a straight line through (ln x, ln y) with errors error/y. Points that are not positive are left out.
Fit fit_power_law(const FitData& data);

/// C(t) = amplitude exp[-(t/time)^exponent] for t <= `until`. `amplitude` > 0 fixes it, as 1 for normalised correlations.
Fit fit_stretched_exponential(const FitData& data, double until = std::numeric_limits<double>::infinity(), double amplitude = 0);
double stretched_exponential(double t, double amplitude, double time, double exponent);

/// eta = prefactor Ca^-exponent, and eta = yield_stress/Ca + prefactor Ca^-exponent (Herschel-Bulkley): x = Ca, y = eta in any unit, the yield stress in
/// that unit. The yield stress may come out negative: it is to be judged by its error.
Fit fit_shear_thinning(const FitData& data);
Fit fit_yield_stress(const FitData& data);

/// Fits the curve and all its resamples: errors and covariance of the parameters then contain the correlations between the points, which
/// (J^T J)^-1 and `probability` ignore. `fitter` gets the points with their own errors.
Fit fit_resampled(const BlockedCurve& curve, const std::function<Fit(const FitData&)>& fitter, const Resampling& resampling = {});

}  // namespace corpuscle::statistics
