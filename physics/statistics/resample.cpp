#include "physics/statistics/resample.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/random.hpp"

namespace corpuscle::statistics {

Eigen::VectorXd BlockedCurve::value(const Eigen::VectorXd& weights) const { return (sums * weights).cwiseQuotient(counts * weights); }

Resampled bootstrap(Eigen::Index blocks, const Statistic& statistic, const Resampling& resampling) {
  Resampled result;
  result.value = statistic(Eigen::VectorXd::Ones(blocks));
  const Eigen::Index n = result.value.size();
  result.error = Eigen::VectorXd::Constant(n, not_a_number);
  result.covariance = Eigen::MatrixXd::Constant(n, n, not_a_number);
  if (blocks < 2 || resampling.resamples < 2) return result;

  RandomStream random(resampling.seed);
  Eigen::MatrixXd draws(n, resampling.resamples);
  Eigen::VectorXd weights(blocks);
  Eigen::Index kept = 0;
  for (int i = 0; i < resampling.resamples; ++i) {
    weights.setZero();
    for (Eigen::Index k = 0; k < blocks; ++k) {
      const auto pick = static_cast<Eigen::Index>(random.uniform() * static_cast<double>(blocks));
      weights[std::min(pick, blocks - 1)] += 1;
    }
    const Eigen::VectorXd draw = statistic(weights);
    const bool complete = (result.value.array().isNaN() || !draw.array().isNaN()).all();
    if (!complete) {
      ++result.failed;
      continue;
    }
    draws.col(kept++) = draw;
  }
  if (kept < 2) return result;
  draws.conservativeResize(Eigen::NoChange, kept);
  draws.colwise() -= draws.rowwise().mean().eval();
  const auto b = static_cast<double>(blocks);
  const double scale = b / ((b - 1) * static_cast<double>(kept - 1));
  result.error = (draws.rowwise().squaredNorm() * scale).cwiseSqrt();
  if (n <= 64) result.covariance = draws * draws.transpose() * scale;  // of long curves nobody asks for it
  return result;
}

Curve with_errors(const BlockedCurve& curve, const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& transform, const Resampling& resampling) {
  Curve result;
  result.x = curve.x;
  const Statistic statistic = [&](const Eigen::VectorXd& weights) {
    const Eigen::VectorXd value = curve.value(weights);
    return transform ? transform(value) : value;
  };
  const Resampled resampled = bootstrap(curve.blocks(), statistic, resampling);
  result.value = resampled.value;
  result.error = resampled.error;
  result.trusted_until = curve.trusted_until();
  if (!curve.reason.empty()) {
    result.reason = curve.reason;
  } else if (curve.blocks() < blocks_to_trust) {
    result.reason = fmt::format("{} blocks are too few for an error (at least {})", curve.blocks(), blocks_to_trust);
  } else if (curve.x.size() > 0 && curve.x.maxCoeff() > result.trusted_until) {
    result.reason = fmt::format("errors beyond x = {:.3g}, half of a block, are too small", result.trusted_until);
  } else {
    result.converged = true;
  }
  return result;
}

Estimate estimate_from(const BlockedCurve& curve, const std::function<double(const Eigen::VectorXd&)>& number, const Resampling& resampling) {
  Estimate result;
  if (!curve.reason.empty()) {
    result.reason = curve.reason;
    return result;
  }
  const Statistic statistic = [&](const Eigen::VectorXd& weights) { return Eigen::VectorXd::Constant(1, number(curve.value(weights))); };
  const Resampled resampled = bootstrap(curve.blocks(), statistic, resampling);
  result.value = resampled.value[0];
  result.error = resampled.error[0];
  result.effective_samples = static_cast<double>(curve.blocks());
  if (std::isnan(result.value)) {
    result.reason = "the number cannot be computed from this curve";
  } else if (curve.blocks() < blocks_to_trust) {
    result.reason = fmt::format("{} blocks are too few for an error (at least {})", curve.blocks(), blocks_to_trust);
  } else if (10 * resampled.failed > resampling.resamples) {
    result.reason = fmt::format("{} of {} resamples of the data gave no number", resampled.failed, resampling.resamples);
  } else {
    result.converged = true;
  }
  return result;
}

Eigen::Index block_count(Eigen::Index samples, double correlation_time, Eigen::Index fewest, Eigen::Index most) {
  const double independent = static_cast<double>(samples) / (10 * std::max(correlation_time, 0.5));
  const auto wanted = static_cast<Eigen::Index>(std::isfinite(independent) ? independent : 0);
  return std::clamp(wanted, std::min(fewest, samples), std::max(std::min(most, samples), std::min(fewest, samples)));
}

}  // namespace corpuscle::statistics
