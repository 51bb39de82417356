#include "physics/statistics/fit.hpp"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/SpecialFunctions>

namespace corpuscle::statistics {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double largest_condition = 1e10;  // of the scaled Jacobian: beyond it its inverse has no digits, derivatives being good to 1e-10

// In the form that Eigen's optimiser expects. Derivatives by central differences over steps of cbrt(epsilon): an error of 1e-10. Eigen's NumericalDiff
// takes steps relative to the parameter, which vanish with it (logarithms do).
struct Functor {
  using Scalar = double;
  using InputType = VectorXd;
  using ValueType = VectorXd;
  using JacobianType = MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  const Residuals* residuals;
  const std::vector<bool>* positive;
  VectorXd scale;  // of each parameter, for the steps
  Index count;

  VectorXd outside(const VectorXd& inside) const {
    VectorXd p = inside;
    for (Index i = 0; i < p.size(); ++i) {
      if ((*positive)[static_cast<std::size_t>(i)]) p[i] = std::exp(std::clamp(inside[i], -700.0, 700.0));
    }
    return p;
  }
  Index values() const { return count; }
  int operator()(const VectorXd& inside, VectorXd& result) const {
    result = (*residuals)(outside(inside));
    // A step too far must look bad, not end the search.
    result = result.array().isFinite().select(result, 1e150);
    return 0;
  }
  int df(const VectorXd& inside, MatrixXd& jacobian) const {
    VectorXd forward, backward, moved = inside;
    for (Index i = 0; i < inside.size(); ++i) {
      const double step = 6e-6 * std::max(scale[i], std::abs(inside[i]));
      moved[i] = inside[i] + step;
      (*this)(moved, forward);
      moved[i] = inside[i] - step;
      (*this)(moved, backward);
      jacobian.col(i) = (forward - backward) / (2 * step);
      moved[i] = inside[i];
    }
    return 0;
  }
};

Fit failed(std::vector<std::string> names, std::string reason) {
  Fit fit;
  const auto n = static_cast<Index>(names.size());
  fit.names = std::move(names);
  fit.parameters = fit.errors = VectorXd::Constant(n, not_a_number);
  fit.covariance = MatrixXd::Constant(n, n, not_a_number);
  fit.reason = std::move(reason);
  return fit;
}

// (J^T J)^-1 of the Jacobian with columns scaled to length one. False where the data leave a combination of parameters open; it is named.
bool set_covariance(Fit& fit, const MatrixXd& jacobian) {
  const VectorXd lengths = jacobian.colwise().norm();
  for (Index i = 0; i < lengths.size(); ++i) {
    if (lengths[i] > 0 && std::isfinite(lengths[i])) continue;
    fit.reason = fmt::format("the data don't depend on {}", fit.names[static_cast<std::size_t>(i)]);
    return false;
  }
  const Eigen::JacobiSVD<MatrixXd> svd(jacobian * lengths.cwiseInverse().asDiagonal(), Eigen::ComputeThinV);
  const VectorXd& singular = svd.singularValues();
  if (!(singular.minCoeff() * largest_condition > singular.maxCoeff())) {
    fit.reason = "the data don't determine all parameters";
    return false;
  }
  const MatrixXd scaled = lengths.cwiseInverse().asDiagonal() * svd.matrixV() * singular.cwiseInverse().asDiagonal();
  fit.covariance = scaled * scaled.transpose();
  return true;
}

void finish(Fit& fit, bool scale_covariance) {
  if (scale_covariance) {
    fit.covariance *= fit.degrees_of_freedom > 0 ? fit.chi2 / fit.degrees_of_freedom : not_a_number;
  } else if (fit.degrees_of_freedom > 0) {
    fit.probability = Eigen::numext::igammac(0.5 * fit.degrees_of_freedom, 0.5 * fit.chi2);
  }
  fit.errors = fit.covariance.diagonal().cwiseSqrt();
  if (fit.errors.array().isNaN().any()) {
    fit.converged = false;
    fit.reason = fmt::format("{} parameters from as many points without errors have none either", fit.names.size());
  }
}

struct Points {
  VectorXd x, y, error;
};

Points usable(const FitData& data) {
  const bool known = data.error.size() > 0;
  Points points{data.x, data.y, data.x};
  Index n = 0;
  for (Index i = 0; i < data.x.size(); ++i) {
    const double error = known ? data.error[i] : data.relative ? std::abs(data.y[i]) : 1;
    if (!std::isfinite(data.x[i]) || !std::isfinite(data.y[i]) || !(error > 0) || !std::isfinite(error)) continue;
    points.x[n] = data.x[i];
    points.y[n] = data.y[i];
    points.error[n++] = error;
  }
  points.x.conservativeResize(n);
  points.y.conservativeResize(n);
  points.error.conservativeResize(n);
  return points;
}

Fit too_few(const std::vector<std::string>& names, Index points) {
  return failed(names, fmt::format("{} valid points are too few for {} parameters", points, names.size()));
}

// Weighted linear least squares with the columns of `design`.
Fit fit_linear(std::vector<std::string> names, const MatrixXd& design, const VectorXd& y, const VectorXd& error, bool scale_covariance) {
  if (y.size() < design.cols()) return too_few(names, y.size());
  Fit fit = failed(std::move(names), {});
  const MatrixXd weighted = error.cwiseInverse().asDiagonal() * design;
  if (!set_covariance(fit, weighted)) return fit;
  const VectorXd target = y.cwiseQuotient(error);
  fit.parameters = weighted.colPivHouseholderQr().solve(target);
  fit.chi2 = (weighted * fit.parameters - target).squaredNorm();
  fit.degrees_of_freedom = static_cast<int>(y.size() - design.cols());
  fit.converged = true;
  finish(fit, scale_covariance);
  return fit;
}

}  // namespace

Estimate Fit::parameter(const std::string& name) const {
  Estimate result;
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    result.reason = fmt::format("the model has no parameter {}", name);
    return result;
  }
  const auto i = static_cast<Index>(found - names.begin());
  result.value = parameters[i];
  result.error = errors[i];
  result.effective_samples = static_cast<double>(degrees_of_freedom) + static_cast<double>(names.size());
  result.converged = converged;
  result.reason = reason;
  return result;
}

Fit least_squares(const Residuals& residuals, const FitProblem& problem) {
  Fit fit = failed(problem.names, {});
  std::vector<bool> positive = problem.positive;
  positive.resize(problem.names.size(), false);
  VectorXd inside = problem.start, scale = (problem.start.array() != 0).select(1e-3 * problem.start.cwiseAbs(), VectorXd::Ones(problem.start.size()));
  for (Index i = 0; i < inside.size(); ++i) {
    if (!positive[static_cast<std::size_t>(i)]) continue;
    inside[i] = std::log(inside[i]);
    scale[i] = 1;
  }
  if (!inside.allFinite()) {
    fit.reason = "the data give no starting point for the search";
    return fit;
  }
  const Index points = residuals(problem.start).size(), count = inside.size();
  if (points < count) return too_few(problem.names, points);

  Functor functor;
  functor.residuals = &residuals;
  functor.positive = &positive;
  functor.scale = scale;
  functor.count = points;
  Eigen::LevenbergMarquardt<Functor> search(functor);
  search.parameters.ftol = search.parameters.xtol = 1e-12;
  search.parameters.maxfev = 400 * static_cast<int>(count + 1);
  const auto status = search.minimize(inside);

  VectorXd remaining;
  functor(inside, remaining);
  fit.parameters = functor.outside(inside);
  fit.chi2 = remaining.squaredNorm();
  fit.degrees_of_freedom = static_cast<int>(points - count);
  if (status <= 0 || status == Eigen::LevenbergMarquardtSpace::TooManyFunctionEvaluation || status == Eigen::LevenbergMarquardtSpace::UserAsked ||
      !std::isfinite(fit.chi2) || remaining.cwiseAbs().maxCoeff() >= 1e150) {
    fit.reason = "the search for the minimum didn't end";
    return fit;
  }
  MatrixXd jacobian(points, count);
  functor.df(inside, jacobian);
  if (!set_covariance(fit, jacobian)) return fit;
  fit.converged = true;
  for (Index i = 0; i < count; ++i) {
    if (!positive[static_cast<std::size_t>(i)]) continue;
    fit.covariance.row(i) *= fit.parameters[i];
    fit.covariance.col(i) *= fit.parameters[i];
  }
  finish(fit, problem.scale_covariance);
  for (Index i = 0; i < count && fit.converged; ++i) {
    if (!positive[static_cast<std::size_t>(i)] || fit.errors[i] < fit.parameters[i]) continue;
    fit.converged = false;
    fit.reason = fmt::format("the error of {} is larger than its value", fit.names[static_cast<std::size_t>(i)]);
  }
  return fit;
}

Fit fit_model(const Model& model, const FitData& data, FitProblem problem) {
  const Points points = usable(data);
  if (points.x.size() < static_cast<Index>(problem.names.size())) return too_few(problem.names, points.x.size());
  problem.scale_covariance = data.error.size() == 0;
  const Residuals residuals = [&](const VectorXd& parameters) {
    VectorXd r(points.x.size());
    for (Index i = 0; i < r.size(); ++i) r[i] = (points.y[i] - model(points.x[i], parameters)) / points.error[i];
    return r;
  };
  return least_squares(residuals, problem);
}

Fit fit_line(const FitData& data) {
  const Points points = usable(data);
  MatrixXd design(points.x.size(), 2);
  design << VectorXd::Ones(points.x.size()), points.x;
  return fit_linear({"intercept", "slope"}, design, points.y, points.error, data.error.size() == 0);
}

Fit fit_proportional(const FitData& data) {
  const Points points = usable(data);
  return fit_linear({"slope"}, points.x, points.y, points.error, data.error.size() == 0);
}

Fit fit_power_law(const FitData& data) {
  const auto positive = [](const VectorXd& v) { return (v.array() > 0).select(v, not_a_number).eval(); };
  FitData logarithms;
  const VectorXd y = positive(data.y);
  logarithms.x = positive(data.x).array().log();
  logarithms.y = y.array().log();
  if (data.error.size() > 0) logarithms.error = data.error.cwiseQuotient(y);
  Fit fit = fit_line(logarithms);
  fit.names = {"prefactor", "exponent"};
  if (!fit.converged) return fit;
  // ln prefactor -> prefactor
  const double prefactor = std::exp(fit.parameters[0]);
  fit.parameters[0] = prefactor;
  fit.errors[0] *= prefactor;
  fit.covariance.row(0) *= prefactor;
  fit.covariance.col(0) *= prefactor;
  return fit;
}

double stretched_exponential(double t, double amplitude, double time, double exponent) {
  return amplitude * std::exp(-std::pow(t / time, exponent));
}

Fit fit_stretched_exponential(const FitData& data, double until, double amplitude) {
  const bool fixed = amplitude > 0;
  std::vector<std::string> names{"time", "exponent"};
  if (!fixed) names.insert(names.begin(), "amplitude");
  FitData window = data;
  window.y = (data.x.array() >= 0 && data.x.array() <= until).select(data.y, not_a_number);
  const Points points = usable(window);
  if (points.x.size() < static_cast<Index>(names.size())) return too_few(names, points.x.size());

  // Start: the first value, and where 1/e of it is passed.
  const double first = fixed ? amplitude : points.y[0];
  double time = points.x[points.x.size() - 1];
  for (Index i = 0; i < points.x.size(); ++i) {
    if (points.y[i] > first * std::exp(-1) || !(points.x[i] > 0)) continue;
    time = points.x[i];
    break;
  }
  FitProblem problem{.names = names, .start = VectorXd(static_cast<Index>(names.size())), .positive = std::vector<bool>(names.size(), true)};
  if (fixed) {
    problem.start << time, 1;
  } else {
    problem.start << first, time, 1;
  }
  if (!(first > 0)) return failed(names, "the correlation doesn't start with a positive value");
  const Model model = [=](double t, const VectorXd& p) {
    return fixed ? stretched_exponential(t, amplitude, p[0], p[1]) : stretched_exponential(t, p[0], p[1], p[2]);
  };
  return fit_model(model, window, problem);
}

Fit fit_shear_thinning(const FitData& data) {
  Fit fit = fit_power_law(data);
  if (fit.parameters.size() < 2) return fit;
  fit.parameters[1] *= -1;
  fit.covariance.row(1) *= -1;
  fit.covariance.col(1) *= -1;
  return fit;
}

Fit fit_yield_stress(const FitData& data) {
  const std::vector<std::string> names{"yield_stress", "prefactor", "exponent"};
  FitData viscosity = data;
  viscosity.relative = true;
  viscosity.x = (data.x.array() > 0).select(data.x, not_a_number);
  const Points points = usable(viscosity);
  if (points.x.size() < 3) return too_few(names, points.x.size());
  // For a given exponent the model is linear: the best of a few exponents is the start.
  FitProblem problem{.names = names, .start = VectorXd::Constant(3, not_a_number), .positive = {false, true, false}};
  double smallest = std::numeric_limits<double>::infinity();
  for (double q = 0; q < 0.95; q += 0.05) {
    MatrixXd design(points.x.size(), 2);
    design << points.x.cwiseInverse(), points.x.array().pow(-q).matrix();
    const Fit trial = fit_linear({"yield_stress", "prefactor"}, design, points.y, points.error, true);
    if (!(trial.chi2 < smallest) || !(trial.parameters[1] > 0)) continue;
    smallest = trial.chi2;
    problem.start << trial.parameters[0], trial.parameters[1], q;
  }
  const Model model = [](double capillary, const VectorXd& p) { return p[0] / capillary + p[1] * std::pow(capillary, -p[2]); };
  return fit_model(model, viscosity, problem);
}

Fit fit_resampled(const BlockedCurve& curve, const std::function<Fit(const FitData&)>& fitter, const Resampling& resampling) {
  const Curve points = with_errors(curve, {}, resampling);
  FitData data{.x = points.x, .y = points.value, .error = points.error};
  Fit fit = fitter(data);
  if (!curve.reason.empty()) {
    fit.converged = false;
    fit.reason = curve.reason;
  }
  if (!fit.converged) return fit;
  const Resampled resampled = bootstrap(
      curve.blocks(),
      [&](const VectorXd& weights) {
        data.y = curve.value(weights);
        const Fit trial = fitter(data);
        return trial.converged ? trial.parameters : VectorXd::Constant(fit.parameters.size(), not_a_number).eval();
      },
      resampling);
  fit.errors = resampled.error;
  fit.covariance = resampled.covariance;
  if (curve.blocks() < blocks_to_trust) {
    fit.converged = false;
    fit.reason = fmt::format("{} blocks are too few for an error (at least {})", curve.blocks(), blocks_to_trust);
  } else if (10 * resampled.failed > resampling.resamples) {
    fit.converged = false;
    fit.reason = fmt::format("the fit failed for {} of {} resamples of the data", resampled.failed, resampling.resamples);
  }
  return fit;
}

}  // namespace corpuscle::statistics
