#include "physics/statistics/tumbling.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace corpuscle::statistics {
namespace {

constexpr double pi = std::numbers::pi;

/// Times of the passages of one cell. `angle`: of the projection against +z, continued over full turns.
std::vector<double> passages(const std::vector<double>& angle) {
  std::vector<double> times;
  if (angle.size() < 2) return times;
  const double sense = angle.back() >= angle.front() ? 1 : -1;
  double next = pi * std::ceil(sense * angle.front() / pi);
  for (std::size_t t = 1; t < angle.size(); ++t) {
    const double before = sense * angle[t - 1], now = sense * angle[t];
    if (std::isnan(now)) continue;
    while (now >= next) {
      times.push_back(static_cast<double>(t) - 1 + (now > before ? (next - before) / (now - before) : 1));
      next += pi;
    }
  }
  return times;
}

}  // namespace

Estimate tumbling_period(const AxisSeries& axes, double time_step) {
  std::vector<double> halves;
  for (Eigen::Index cell = 0; cell < axes.x.cols(); ++cell) {
    std::vector<double> angle;
    double last = not_a_number;
    bool whole = true;
    for (Eigen::Index t = 0; t < axes.x.rows(); ++t) {
      const double here = std::atan2(axes.x(t, cell), axes.z(t, cell));
      // Turns by more than a right angle between two samples can't be followed, nor through a gap.
      if (!std::isnan(last)) last += std::remainder(here - last, pi);
      else last = here;
      whole = whole && !std::isnan(here);
      angle.push_back(last);
    }
    if (!whole) continue;
    const auto times = passages(angle);
    for (std::size_t i = 1; i < times.size(); ++i) halves.push_back((times[i] - times[i - 1]) * time_step);
  }
  Estimate result;
  if (halves.empty()) {
    result.reason = "no cell passes through the gradient direction twice: none tumbles, or the run is too short";
    return result;
  }
  const auto n = static_cast<double>(halves.size());
  double mean = 0, squares = 0;
  for (const double h : halves) mean += h / n;
  for (const double h : halves) squares += (h - mean) * (h - mean);
  result.value = 2 * mean;
  result.effective_samples = n;
  result.converged = halves.size() >= 3;
  if (result.converged) result.error = 2 * std::sqrt(squares / (n * (n - 1)));
  else result.reason = fmt::format("there are only {} half turns: run longer", halves.size());
  return result;
}

}  // namespace corpuscle::statistics
