// Block bootstrap: errors of curves, and of any number computed from them, out of the scatter between independent blocks.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <string>
#include <utility>

#include "physics/statistics/estimate.hpp"

namespace corpuscle::statistics {

/// A curve whose points are ratios of sums, kept per block (stretch of time or group of particles): value(x) = sum_b sums(x, b) / sum_b counts(x, b).
/// Everything drawn from the curve (its error, a fit, an integral) is found by resampling whole blocks, which carries the correlations between its
/// points along (Künsch 1989; Efron & Tibshirani 1993, ch. 8).
struct BlockedCurve {
  Eigen::VectorXd x;
  Eigen::MatrixXd sums, counts;  ///< [points][blocks]
  double block_length = not_a_number;  ///< in units of x where x is a time lag and blocks are stretches of time
  std::string reason;            ///< why there is nothing, empty otherwise

  /// Blocks share the samples of pairs that reach over their ends: at lags beyond half of a block errors come out too small.
  double trusted_until() const { return block_length > 0 ? block_length / 2 : std::numeric_limits<double>::infinity(); }
  Eigen::Index points() const { return sums.rows(); }
  Eigen::Index blocks() const { return sums.cols(); }
  Eigen::VectorXd value() const { return value(Eigen::VectorXd::Ones(blocks())); }
  /// With weights of the blocks; NaN where no sample exists.
  Eigen::VectorXd value(const Eigen::VectorXd& weights) const;
};

/// Weights of blocks -> numbers. Entries may be NaN where they cannot be computed.
using Statistic = std::function<Eigen::VectorXd(const Eigen::VectorXd& weights)>;

struct Resampled {
  Eigen::VectorXd value;       ///< of all blocks with weight 1
  Eigen::VectorXd error;
  Eigen::MatrixXd covariance;
  int failed = 0;              ///< resamples of which an entry that exists for the full data was NaN
};

/// Standard deviation over resamples of the blocks with replacement, times sqrt(B/(B-1)), which makes it exact for means. NaN below 2 blocks.
Resampled bootstrap(Eigen::Index blocks, const Statistic& statistic, const Resampling& resampling = {});

inline constexpr Eigen::Index blocks_to_trust = 8;  ///< the error of an error from B blocks is 1/sqrt(2(B-1)): 27 % at 8

/// Values and errors of all points, those of `transform` applied to the curve when given. Converged when there are enough blocks and no point lies beyond
/// `trusted_until`.
Curve with_errors(const BlockedCurve& curve, const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& transform = {},
                  const Resampling& resampling = {});

/// One number computed from the curve. `correlation_time` is left NaN; effective samples are the blocks.
Estimate estimate_from(const BlockedCurve& curve, const std::function<double(const Eigen::VectorXd&)>& number, const Resampling& resampling = {});

/// Length in samples of blocks that are nearly independent: 10 correlation times, but at least `fewest` blocks and at most `most` in `samples`.
Eigen::Index block_count(Eigen::Index samples, double correlation_time, Eigen::Index fewest = 10, Eigen::Index most = 32);

}  // namespace corpuscle::statistics
