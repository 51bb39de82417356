#include "physics/statistics/autocorrelation_time.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "physics/statistics/estimate.hpp"

namespace corpuscle::statistics {
namespace {

constexpr double window_factor = 5;     // Sokal's c: the window is the first lag W >= c tau(W)
constexpr double smallest_time = 0.05;  // anti-correlated series: don't claim an error much below the data's scatter

struct LagSum {
  double covariance = 0;  // mean over the pairs
  double pairs = 0;
};

// Missing samples have deviation 0 and `valid` 0, so they add to neither sum.
LagSum at_lag(const std::vector<double>& deviation, const std::vector<double>& valid, bool gaps, std::size_t lag) {
  const std::size_t n = deviation.size() - lag;
  double sum = 0, pairs = static_cast<double>(n);
  for (std::size_t i = 0; i < n; ++i) sum += deviation[i] * deviation[i + lag];
  if (gaps) {
    pairs = 0;
    for (std::size_t i = 0; i < n; ++i) pairs += valid[i] * valid[i + lag];
  }
  return {pairs > 0 ? sum / pairs : 0, pairs};
}

}  // namespace

AutocorrelationTime autocorrelation_time(std::span<const double> series) {
  AutocorrelationTime result{.time = not_a_number, .error = not_a_number, .mean = not_a_number, .variance = not_a_number, .mean_variance = not_a_number};
  const auto present = [](double x) { return !std::isnan(x); };
  const auto first = std::find_if(series.begin(), series.end(), present);
  const auto last = std::find_if(series.rbegin(), series.rend(), present).base();
  if (first == series.end()) return result;
  std::vector<double> deviation(first, last), valid(deviation.size());
  double sum = 0, n = 0;
  for (std::size_t i = 0; i < deviation.size(); ++i) {
    valid[i] = present(deviation[i]) ? 1 : 0;
    n += valid[i];
    if (valid[i] > 0) sum += deviation[i];
  }
  result.valid_samples = n;
  result.mean = sum / n;
  if (n < 2) return result;
  for (std::size_t i = 0; i < deviation.size(); ++i) deviation[i] = valid[i] > 0 ? deviation[i] - result.mean : 0;

  const bool gaps = n < static_cast<double>(deviation.size());
  const double variance = at_lag(deviation, valid, gaps, 0).covariance;
  // Rounding of a constant series isn't noise: its correlations would be meaningless.
  const double rounding = 1e-14 * std::abs(result.mean);
  if (variance <= rounding * rounding) {
    result.constant = result.window_closed = true;
    result.time = 0.5;
    result.error = result.variance = result.mean_variance = 0;
    return result;
  }

  // Lags beyond half of the series carry no information.
  const std::size_t last_lag = std::max<std::size_t>(deviation.size() / 2, 1);
  double covariance_sum = variance;  // Gamma(0) + 2 sum Gamma(t) = 2 tau Gamma(0)
  double mean_sum = variance;        // the same weighted with the share of pairs that exist: what the mean's variance sees
  double weights = 1;                // sum of those weights
  std::size_t lag = 1;
  for (; lag <= last_lag && lag < deviation.size(); ++lag) {
    const auto [covariance, pairs] = at_lag(deviation, valid, gaps, lag);
    const double all = static_cast<double>(deviation.size());
    const double weight = pairs / (all - static_cast<double>(lag)) * all / n;  // 1 without gaps
    covariance_sum += 2 * covariance;
    mean_sum += 2 * weight * covariance;
    weights += 2 * weight;
    result.window = static_cast<int>(lag);
    if (static_cast<double>(lag) >= window_factor * covariance_sum / (2 * variance)) {
      result.window_closed = true;
      break;
    }
  }
  const double correction = std::max(mean_sum, 0.0) / n;
  covariance_sum += correction * (1 + 2 * static_cast<double>(result.window));
  mean_sum += correction * weights;
  result.variance = variance + correction;
  result.time = std::clamp(covariance_sum / (2 * result.variance), smallest_time, static_cast<double>(deviation.size()) / 2);
  const double spread = 4 * std::max(result.window + 0.5 - result.time, 0.5) / static_cast<double>(deviation.size());
  result.error = result.time * std::min(1.0, std::sqrt(spread));
  result.mean_variance = 2 * std::clamp(mean_sum / (2 * result.variance), smallest_time, n / 2) * result.variance / n;
  return result;
}

}  // namespace corpuscle::statistics
