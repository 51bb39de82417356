#include "physics/statistics/equilibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace corpuscle::statistics {
namespace {

constexpr std::size_t smallest_batch = 5;
constexpr std::size_t most_batches = 200;   // larger batches keep a correlated series' short quiet stretches from looking like a minimum
constexpr std::size_t fewest_batches = 10;

}  // namespace

Equilibration equilibration(std::span<const double> series) {
  const std::size_t batch = std::max(smallest_batch, (series.size() + most_batches - 1) / most_batches);
  std::vector<double> means;
  std::vector<std::size_t> starts;
  for (std::size_t from = 0; from + batch <= series.size(); from += batch) {
    double sum = 0, valid = 0;
    for (const double x : series.subspan(from, batch)) {
      if (std::isnan(x)) continue;
      sum += x;
      valid += 1;
    }
    if (valid == 0) continue;
    means.push_back(sum / valid);
    starts.push_back(from);
  }
  Equilibration result;
  if (means.size() < fewest_batches) {
    result.reason = fmt::format("{} valid samples in batches of {} are too few to see where the start-up ends", means.size() * batch, batch);
    return result;
  }

  // Sums from the back, about the last batch's mean so that a large mean costs no digits.
  const double shift = means.back();
  double sum = 0, squares = 0, smallest = 0, scale = 0;
  std::size_t best = 0;
  bool found = false;
  const std::size_t tail = std::max<std::size_t>(means.size() / 10, 5);
  for (std::size_t d = means.size(); d-- > 0;) {
    const double y = means[d] - shift;
    sum += y;
    squares += y * y;
    scale = std::max(scale, std::abs(means[d]));
    const auto n = static_cast<double>(means.size() - d);
    if (means.size() - d < tail) continue;
    // Below the rounding of the samples the criterion is noise: the constant series starts at its beginning.
    const double criterion = std::max(squares - sum * sum / n, 1e-28 * scale * scale * n) / (n * n);
    if (!found || criterion <= smallest) {
      smallest = criterion;
      best = d;
      found = true;
    }
  }
  if (2 * best > means.size()) {
    result.first = series.size() / 2;
    result.reason = "the start-up lasts beyond half of the series: run longer";
    return result;
  }
  result.first = best == 0 ? 0 : starts[best];
  result.converged = true;
  return result;
}

}  // namespace corpuscle::statistics
