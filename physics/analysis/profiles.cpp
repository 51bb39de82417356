#include <algorithm>
#include <cmath>

#include "physics/analysis/groups.hpp"
#include "physics/statistics/resample.hpp"

namespace corpuscle::analysis {

statistics::ProfileOptions layers_of(const SteadyState& state, Eigen::Index blocks) {
  const auto layers = static_cast<Eigen::Index>(std::lround(2 * state.height() / state.record.radius));
  return {.low = 0, .high = state.height(), .bins = std::clamp<Eigen::Index>(layers, 1, 150), .blocks = blocks};
}

statistics::Curve profile_curve(const SteadyState& state, const statistics::BlockedCurve& profile, double unit) {
  statistics::Curve curve = statistics::with_errors(profile);
  curve.x /= state.record.radius;
  curve.value /= unit;
  curve.error /= unit;
  return curve;
}

}  // namespace corpuscle::analysis
