#include "physics/statistics/mean_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "physics/statistics/autocorrelation_time.hpp"

namespace corpuscle::statistics {
namespace {

constexpr double times_to_trust = 20;
constexpr int blocks_to_trust = 8;

}  // namespace

MeanError mean_error(std::span<const double> series) {
  const AutocorrelationTime tau = autocorrelation_time(series);
  MeanError result{.mean = tau.mean, .error = not_a_number, .correlation_time = not_a_number, .effective_samples = tau.valid_samples, .converged = false};
  if (tau.valid_samples < 2) return result;
  result.error = std::sqrt(tau.mean_variance);
  result.correlation_time = tau.time;
  if (!tau.constant) result.effective_samples = tau.variance / tau.mean_variance;
  result.converged = tau.window_closed && tau.valid_samples >= times_to_trust * tau.time;
  return result;
}

Estimate mean_estimate(std::span<const double> series, double time_step) {
  const MeanError mean = mean_error(series);
  Estimate result{.value = mean.mean,
                  .error = mean.error,
                  .correlation_time = mean.correlation_time * time_step,
                  .effective_samples = mean.effective_samples,
                  .converged = mean.converged,
                  .reason = {}};
  if (mean.converged) return result;
  if (std::isnan(mean.mean)) {
    result.reason = "the series has no valid sample";
  } else if (std::isnan(mean.error)) {
    result.reason = "one sample has no error";
  } else {
    result.reason = fmt::format("the series ({} samples) is shorter than {:g} of its correlation times ({:.3g} samples)", series.size(), times_to_trust,
                                mean.correlation_time);
  }
  return result;
}

Estimate block_mean(std::span<const double> series, int blocks, double time_step) {
  Estimate result;
  std::vector<double> means, weights;
  const std::size_t count = std::min<std::size_t>(static_cast<std::size_t>(std::max(blocks, 1)), series.size());
  double sum = 0, samples = 0, squares = 0;
  for (std::size_t b = 0; b < count; ++b) {
    const std::size_t from = b * series.size() / count, to = (b + 1) * series.size() / count;
    double block = 0, valid = 0;
    for (std::size_t i = from; i < to; ++i) {
      if (std::isnan(series[i])) continue;
      block += series[i];
      squares += series[i] * series[i];
      valid += 1;
    }
    sum += block;
    samples += valid;
    if (valid > 0) {
      means.push_back(block / valid);
      weights.push_back(valid);
    }
  }
  if (samples == 0) {
    result.reason = "the series has no valid sample";
    return result;
  }
  result.value = sum / samples;
  const auto n = static_cast<double>(means.size());
  result.effective_samples = n;
  if (means.size() < 2) {
    result.reason = "one block has no error";
    return result;
  }
  double scatter = 0, neighbours = 0;
  for (std::size_t b = 0; b < means.size(); ++b) {
    const double share = weights[b] * n / samples;
    means[b] = share * (means[b] - result.value);
    scatter += means[b] * means[b];
    if (b > 0) neighbours += means[b] * means[b - 1];
  }
  result.error = std::sqrt(scatter / (n * (n - 1)));
  double variance = 0;
  for (const double x : series) variance += std::isnan(x) ? 0 : (x - result.value) * (x - result.value);
  variance /= samples;
  if (variance > 1e-28 * squares / samples) result.correlation_time = result.error * result.error * samples / (2 * variance) * time_step;
  if (means.size() < blocks_to_trust) {
    result.reason = fmt::format("{} blocks are too few for an error (at least {})", means.size(), blocks_to_trust);
  } else if (scatter > 0 && neighbours / scatter > 2 / std::sqrt(n)) {  // 2 sigma of the correlation of n independent blocks
    result.reason = "neighbouring blocks are correlated: the series is too short for its correlation time or drifts";
  } else {
    result.converged = true;
  }
  return result;
}

}  // namespace corpuscle::statistics
