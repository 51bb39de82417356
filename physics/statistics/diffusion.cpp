#include "physics/statistics/diffusion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/SpecialFunctions>

namespace corpuscle::statistics {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Slope of the least-squares line through the points first ... last-1; NaN when one is missing.
double slope_of(const VectorXd& x, const VectorXd& y, Index first, Index last) {
  const Index n = last - first;
  const double mean_x = x.segment(first, n).mean(), mean_y = y.segment(first, n).mean();
  double covariance = 0, variance = 0;
  for (Index i = first; i < last; ++i) {
    covariance += (x[i] - mean_x) * (y[i] - mean_y);
    variance += (x[i] - mean_x) * (x[i] - mean_x);
  }
  return covariance / variance;
}

double trapezoid(const VectorXd& x, const VectorXd& y, Index last) {
  double sum = 0;
  for (Index i = 1; i <= last; ++i) sum += 0.5 * (x[i] - x[i - 1]) * (y[i] + y[i - 1]);
  return sum;
}

Estimate integral_of(const BlockedCurve& correlation, double to, bool normalised, const Resampling& resampling) {
  Estimate result;
  result.reason = correlation.reason;
  if (!correlation.reason.empty()) return result;
  constexpr double window_factor = 6, smallest_step = 0.6;
  const VectorXd c = correlation.value();
  const Index points = correlation.points();
  if (points < 2 || !(c[0] > 0)) {
    result.reason = "nothing fluctuates, or there is one lag only";
    return result;
  }
  Index last = 0;
  bool closed = false;
  if (to > 0) {
    while (last + 1 < points && correlation.x[last + 1] <= to * (1 + 1e-9)) ++last;
    closed = correlation.x[points - 1] >= to * (1 - 1e-9);
  } else {
    double integral = 0;
    while (last + 1 < points && !closed) {
      ++last;
      integral += 0.5 * (correlation.x[last] - correlation.x[last - 1]) * (c[last] + c[last - 1]);
      closed = correlation.x[last] * c[0] >= window_factor * integral;
    }
  }
  result = estimate_from(correlation, [&](const VectorXd& y) { return trapezoid(correlation.x, y, last) / (normalised ? y[0] : 1); }, resampling);
  result.correlation_time = result.value / (normalised ? 1 : c[0]);
  if (!closed) {
    doubt(result, fmt::format("the correlation hasn't decayed at the longest lag, {:.3g}: its integral is cut short", correlation.x[points - 1]));
  }
  if (c[1] < smallest_step * c[0]) doubt(result, "the samples lie too far apart for an integral: the correlation falls below 60 % within one interval");
  if (correlation.x[last] > correlation.trusted_until()) {
    doubt(result, fmt::format("the error is too small: the integral reaches {:.3g}, over half of a block, {:.3g}", correlation.x[last],
                              correlation.trusted_until()));
  }
  if (!(result.value > 0)) doubt(result, "the integral of the correlation is not positive");
  return result;
}

}  // namespace

Estimate diffusion_from_msd(const BlockedCurve& msd, double from, double to, const Resampling& resampling) {
  Estimate result;
  result.reason = msd.reason;
  if (!msd.reason.empty()) return result;
  if (!(to > 0)) to = std::min(msd.trusted_until(), msd.x[msd.points() - 1]);
  if (!(from > 0)) from = to / 2;
  const double slack = 1e-9 * to;
  Index first = 0, last = 0;
  for (Index i = 0; i < msd.points(); ++i) {
    if (msd.x[i] < from - slack) first = i + 1;
    if (msd.x[i] <= to + slack) last = i + 1;
  }
  if (last - first < 4) {
    result.reason = fmt::format("{} lags between {:.3g} and {:.3g} are too few for a slope (at least 4)", std::max<Index>(last - first, 0), from, to);
    return result;
  }
  const Index middle = (first + last) / 2;
  result = estimate_from(msd, [&](const VectorXd& y) { return slope_of(msd.x, y, first, last) / 2; }, resampling);
  const Estimate bend = estimate_from(
      msd, [&](const VectorXd& y) { return (slope_of(msd.x, y, middle, last) - slope_of(msd.x, y, first, middle)) / 2; }, resampling);
  if (std::abs(bend.value) > 2 * bend.error && std::abs(bend.value) > 0.05 * std::abs(result.value)) {
    doubt(result, fmt::format("the MSD isn't linear between {:.3g} and {:.3g}: its slope changes by {:.0f} %", from, to, 100 * bend.value / result.value));
  }
  if (to > msd.trusted_until() + slack) {
    doubt(result, fmt::format("the error is too small: lags up to {:.3g} are longer than half of a block, {:.3g}", to, msd.trusted_until()));
  }
  if (!(result.value > 0)) doubt(result, "the MSD doesn't grow in this window");
  return result;
}

Estimate diffusion_from_vacf(const BlockedCurve& vacf, double to, const Resampling& resampling) { return integral_of(vacf, to, false, resampling); }

Estimate relaxation_time(const BlockedCurve& correlation, double to, const Resampling& resampling) {
  return integral_of(correlation, to, true, resampling);
}

StretchedDiffusion diffusion_from_stretched_exponential(const BlockedCurve& vacf, double to, const Resampling& resampling) {
  StretchedDiffusion result;
  result.fit = fit_resampled(vacf, [to](const FitData& data) { return fit_stretched_exponential(data, to); }, resampling);
  Estimate& diffusion = result.diffusion;
  diffusion.converged = result.fit.converged;
  diffusion.reason = result.fit.reason;
  diffusion.effective_samples = static_cast<double>(vacf.blocks());
  const VectorXd& p = result.fit.parameters;
  if (p.size() < 3 || p.array().isNaN().any()) return result;
  const double gamma = std::tgamma(1 + 1 / p[2]);
  diffusion.value = p[0] * p[1] * gamma;
  diffusion.correlation_time = p[1] * gamma;
  // d ln Gamma(1 + 1/b)/db = -psi(1 + 1/b)/b^2
  const Eigen::Vector3d gradient(1 / p[0], 1 / p[1], -Eigen::numext::digamma(1 + 1 / p[2]) / (p[2] * p[2]));
  const double relative = gradient.dot(result.fit.covariance * gradient);
  diffusion.error = diffusion.value * std::sqrt(std::max(relative, 0.0));
  if (std::isnan(relative)) diffusion.error = not_a_number;
  return result;
}

}  // namespace corpuscle::statistics
