#include "physics/statistics/dissipation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace corpuscle::statistics {

Estimate gap_size(const DissipationState& state) {
  Estimate gap;
  const double phi = state.volume_fraction, variance = state.velocity_variance.value, viscosity = state.relative_viscosity.value;
  if (!(phi > 0 && phi < 1)) {
    gap.reason = fmt::format("a volume fraction of {:g} has no gap (between 0 and 1)", phi);
    return gap;
  }
  if (!(state.shear_rate > 0 && variance >= 0) || !std::isfinite(viscosity)) {
    gap.reason = "shear rate, velocity variance or viscosity is not known";
    return gap;
  }
  const double bracket = (viscosity - 1) / (1 - phi) - 1;
  if (!(bracket > 0)) {
    gap.reason = fmt::format("the viscosity, {:.3g} eta_0, is too small for the balance at a volume fraction of {:.3g}: above {:.3g} is needed", viscosity, phi,
                             2 - phi);
    return gap;
  }
  gap.value = std::sqrt(variance / bracket) / state.shear_rate;
  // l^2 = variance/bracket: relative errors add in squares, halved by the root.
  const double of_variance = variance > 0 ? state.velocity_variance.error / variance : 0;
  const double of_bracket = state.relative_viscosity.error / (1 - phi) / bracket;
  gap.error = 0.5 * gap.value * std::hypot(of_variance, of_bracket);
  gap.effective_samples = std::min(state.velocity_variance.effective_samples, state.relative_viscosity.effective_samples);
  gap.converged = state.velocity_variance.converged && state.relative_viscosity.converged;
  if (!state.velocity_variance.converged) gap.reason = "velocity variance: " + state.velocity_variance.reason;
  if (!state.relative_viscosity.converged) gap.reason = "viscosity: " + state.relative_viscosity.reason;
  if (gap.converged && of_bracket > 0.5) {
    gap.converged = false;
    gap.reason = "the viscosity's error is more than half of what is left of it in the balance";
  }
  return gap;
}

double gap_in_radii(double volume_fraction) { return 2 * (1 / std::cbrt(volume_fraction) - 1); }

Fit fit_gap_radius(const std::vector<DissipationState>& states, double from) {
  std::vector<double> x, y, error;
  for (const DissipationState& state : states) {
    if (!(state.volume_fraction >= from)) continue;
    const Estimate gap = gap_size(state);
    if (std::isnan(gap.value)) continue;
    x.push_back(gap_in_radii(state.volume_fraction));
    y.push_back(gap.value);
    error.push_back(gap.error);
  }
  const auto map = [](const std::vector<double>& v) {
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size())));
  };
  FitData data{.x = map(x), .y = map(y), .error = map(error)};
  if (!std::all_of(error.begin(), error.end(), [](double e) { return e > 0; })) data.error.resize(0);
  return fit_proportional(data);
}

}  // namespace corpuscle::statistics
