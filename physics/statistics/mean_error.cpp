#include "physics/statistics/mean_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace corpuscle::statistics {
namespace {

constexpr double window_factor = 5;       // Sokal's c: the window is the first lag W >= c tau(W)
constexpr double smallest_time = 0.05;    // anti-correlated series: don't claim an error much below the data's scatter
constexpr double times_to_trust = 20;

// Autocovariance at one lag, unbiased in the number of pairs.
double autocovariance(const std::vector<double>& deviation, std::size_t lag) {
  double sum = 0;
  for (std::size_t i = 0; i + lag < deviation.size(); ++i) sum += deviation[i] * deviation[i + lag];
  return sum / static_cast<double>(deviation.size() - lag);
}

}  // namespace

MeanError mean_error(std::span<const double> series) {
  std::vector<double> values;
  values.reserve(series.size());
  std::copy_if(series.begin(), series.end(), std::back_inserter(values), [](double x) { return !std::isnan(x); });

  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  MeanError result{.mean = nan, .error = nan, .correlation_time = nan, .effective_samples = 0, .converged = false};
  if (values.empty()) return result;
  const auto n = static_cast<double>(values.size());
  double sum = 0;
  for (const double x : values) sum += x;
  result.mean = sum / n;
  result.effective_samples = n;
  if (values.size() < 2) return result;

  for (double& x : values) x -= result.mean;
  const double variance = autocovariance(values, 0);
  // Rounding of a constant series isn't noise: its correlations would be meaningless.
  const double rounding = 1e-14 * std::abs(result.mean);
  if (variance <= rounding * rounding) {
    result.error = 0;
    result.correlation_time = 0.5;
    result.converged = n >= times_to_trust * result.correlation_time;
    return result;
  }

  // tau(W) = 1/2 + sum_{t=1}^{W} rho(t), stopped at the smallest W >= 5 tau(W). Lags beyond n/2 carry no information.
  const std::size_t last_lag = std::max<std::size_t>(values.size() / 2, 1);
  double covariance_sum = variance;  // Gamma(0) + 2 sum Gamma(t) = 2 tau Gamma(0)
  std::size_t window = 0;
  bool closed = false;
  for (std::size_t lag = 1; lag <= last_lag && lag < values.size(); ++lag) {
    covariance_sum += 2 * autocovariance(values, lag);
    window = lag;
    if (static_cast<double>(lag) >= window_factor * covariance_sum / (2 * variance)) {
      closed = true;
      break;
    }
  }
  // Deviations are taken from the sample mean, not the true one, which lowers each Gamma(t) by (2 tau Gamma(0))/n (Wolff 2004).
  const double correction = std::max(covariance_sum, 0.0) / n;
  covariance_sum += correction * (1 + 2 * static_cast<double>(window));
  const double unbiased_variance = variance + correction;
  result.correlation_time = std::clamp(covariance_sum / (2 * unbiased_variance), smallest_time, n / 2);
  result.error = std::sqrt(2 * result.correlation_time * unbiased_variance / n);
  result.effective_samples = n / (2 * result.correlation_time);
  result.converged = closed && n >= times_to_trust * result.correlation_time;
  return result;
}

}  // namespace corpuscle::statistics
