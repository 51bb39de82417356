#include <algorithm>
#include <cmath>

#include "physics/analysis/groups.hpp"
#include "physics/statistics/resample.hpp"

namespace corpuscle::analysis {

statistics::ProfileOptions layers_of(const SteadyState& state, const std::vector<double>& series) {
  const auto layers = static_cast<Eigen::Index>(std::lround(2 * state.height() / state.record.radius));
  return {.low = 0, .high = state.height(), .bins = std::clamp<Eigen::Index>(layers, 1, 150), .blocks = state.blocks(series)};
}

statistics::Curve profile_curve(const SteadyState& state, const statistics::BlockedCurve& profile, double unit, const std::vector<double>& series) {
  statistics::Curve curve = statistics::with_errors(profile);
  curve.x /= state.record.radius;
  curve.value /= unit;
  curve.error /= unit;
  state.judge(curve, series);
  return curve;
}

}  // namespace corpuscle::analysis
