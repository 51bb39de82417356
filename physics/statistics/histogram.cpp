#include "physics/statistics/histogram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "physics/statistics/autocorrelation_time.hpp"

namespace corpuscle::statistics {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

struct Scatter {
  double mean = not_a_number, variance = not_a_number, count = 0;
};

Scatter scatter_of(const SeriesMatrix& values) {
  Scatter scatter;
  double sum = 0, squares = 0;
  for (Index p = 0; p < values.cols(); ++p) {
    for (Index t = 0; t < values.rows(); ++t) {
      const double x = values(t, p);
      if (!std::isfinite(x)) continue;
      sum += x;
      scatter.count += 1;
    }
  }
  if (scatter.count == 0) return scatter;
  scatter.mean = sum / scatter.count;
  for (Index p = 0; p < values.cols(); ++p) {
    for (Index t = 0; t < values.rows(); ++t) {
      const double d = values(t, p) - scatter.mean;
      if (std::isfinite(d)) squares += d * d;
    }
  }
  scatter.variance = squares / scatter.count;
  return scatter;
}

// Of the squared deviation, averaged over particles: what the widths of distributions fluctuate with.
Index stretches(const SeriesMatrix& values, double mean, Index blocks) {
  if (blocks > 0) return std::min(blocks, values.rows());
  std::vector<double> squares(static_cast<std::size_t>(values.rows()), not_a_number), firsts = squares;
  for (Index t = 0; t < values.rows(); ++t) {
    double first = 0, second = 0, count = 0;
    for (Index p = 0; p < values.cols(); ++p) {
      const double d = values(t, p) - mean;
      if (!std::isfinite(d)) continue;
      first += d;
      second += d * d;
      count += 1;
    }
    if (count == 0) continue;
    firsts[static_cast<std::size_t>(t)] = first / count;
    squares[static_cast<std::size_t>(t)] = second / count;
  }
  return block_count(values.rows(), std::max(autocorrelation_time(squares).time, autocorrelation_time(firsts).time));
}

// Of the deviation in standard deviations: <d>, <d^2>, <d^3>, <d^4>.
BlockedCurve powers_of(const SeriesMatrix& values, const Scatter& scatter, Index blocks) {
  BlockedCurve powers;
  if (scatter.count == 0) {
    powers.reason = "there is no valid sample";
  } else {
    const Index count = stretches(values, scatter.mean, blocks);
    const double deviation = std::sqrt(scatter.variance), scale = deviation > 1e-12 * std::abs(scatter.mean) ? 1 / deviation : 0;
    powers.x = VectorXd::LinSpaced(4, 1, 4);
    powers.sums = powers.counts = Eigen::MatrixXd::Zero(4, count);
    for (Index p = 0; p < values.cols(); ++p) {
      for (Index b = 0; b < count; ++b) {
        for (Index t = b * values.rows() / count; t < (b + 1) * values.rows() / count; ++t) {
          const double d = (values(t, p) - scatter.mean) * scale;
          if (!std::isfinite(d)) continue;
          double power = 1;
          for (Index k = 0; k < 4; ++k) powers.sums(k, b) += power *= d;
          powers.counts.col(b).array() += 1;
        }
      }
    }
  }
  return powers;
}

}  // namespace

Histogram histogram(const SeriesMatrix& values, double from, double to, Index bins, Index blocks) {
  Histogram result;
  const Scatter scatter = scatter_of(values);
  if (!(to > from) || bins < 1) {
    result.reason = fmt::format("{} bins from {:g} to {:g} are no range", bins, from, to);
    return result;
  }
  result.edges = VectorXd::LinSpaced(bins + 1, from, to);
  if (scatter.count == 0) {
    result.reason = "there is no valid sample";
    return result;
  }
  const Index count = stretches(values, scatter.mean, blocks);
  result.counts = Eigen::MatrixXd::Zero(bins, count);
  result.samples = VectorXd::Zero(count);
  const double scale = static_cast<double>(bins) / (to - from);
  for (Index p = 0; p < values.cols(); ++p) {
    for (Index b = 0; b < count; ++b) {
      for (Index t = b * values.rows() / count; t < (b + 1) * values.rows() / count; ++t) {
        const double x = values(t, p);
        if (!std::isfinite(x)) continue;
        result.samples[b] += 1;
        const double bin = std::floor((x - from) * scale);
        if (bin >= 0 && bin < static_cast<double>(bins)) result.counts(static_cast<Index>(bin), b) += 1;
      }
    }
  }
  return result;
}

Histogram histogram_around_mean(const SeriesMatrix& values, double reach, Index bins, Index blocks) {
  const Scatter scatter = scatter_of(values);
  const double half = reach * std::sqrt(scatter.variance);
  if (half > 1e-12 * std::abs(scatter.mean)) return histogram(values, scatter.mean - half, scatter.mean + half, bins, blocks);
  Histogram result;
  result.reason = scatter.count == 0 ? "there is no valid sample" : "all samples are equal: the density has no width";
  return result;
}

Curve probability_density(const Histogram& histogram, const Resampling& resampling) {
  BlockedCurve curve;
  curve.reason = histogram.reason;
  if (histogram.reason.empty()) {
    curve.x = histogram.centres();
    curve.sums = histogram.counts / histogram.width();
    curve.counts = histogram.samples.transpose().replicate(histogram.counts.rows(), 1);
  }
  Curve density = with_errors(curve, {}, resampling);
  // No sample in a bin doesn't mean that its density is known to be 0.
  density.error = (density.value.array() > 0).select(density.error, not_a_number);
  return density;
}

Moments moments(const SeriesMatrix& values, Index blocks, const Resampling& resampling) {
  const Scatter scatter = scatter_of(values);
  const BlockedCurve powers = powers_of(values, scatter, blocks);
  const double deviation = std::sqrt(scatter.variance);
  // Central moments from those about the full data's mean, which a resample's mean differs from.
  const auto variance = [](const VectorXd& m) { return m[1] - m[0] * m[0]; };
  const auto defined = [&](double number, const VectorXd& m) { return variance(m) > 0 ? number : not_a_number; };
  Moments result;
  result.mean = estimate_from(powers, [&](const VectorXd& m) { return scatter.mean + deviation * m[0]; }, resampling);
  result.variance = estimate_from(powers, [&](const VectorXd& m) { return deviation * deviation * variance(m); }, resampling);
  result.skewness = estimate_from(
      powers,
      [&](const VectorXd& m) { return defined((m[2] - 3 * m[0] * m[1] + 2 * std::pow(m[0], 3)) / std::pow(variance(m), 1.5), m); }, resampling);
  result.excess_kurtosis = estimate_from(
      powers,
      [&](const VectorXd& m) {
        return defined((m[3] - 4 * m[0] * m[2] + 6 * m[0] * m[0] * m[1] - 3 * std::pow(m[0], 4)) / std::pow(variance(m), 2) - 3, m);
      },
      resampling);
  for (Estimate* shape : {&result.skewness, &result.excess_kurtosis}) {
    if (powers.reason.empty() && std::isnan(shape->value)) shape->reason = "all samples are equal: their distribution has no shape";
  }
  return result;
}

Estimate relative_fluctuation(const SeriesMatrix& values, Index blocks, const Resampling& resampling) {
  const Scatter scatter = scatter_of(values);
  const BlockedCurve powers = powers_of(values, scatter, blocks);
  const double deviation = std::sqrt(scatter.variance);
  const auto mean = [&](const VectorXd& m) { return scatter.mean + deviation * m[0]; };
  Estimate ratio = estimate_from(
      powers,
      [&](const VectorXd& m) {
        const double about = std::abs(mean(m));
        return about > 0 ? deviation * std::sqrt(std::max(m[1] - m[0] * m[0], 0.0)) / about : not_a_number;
      },
      resampling);
  const Estimate level = estimate_from(powers, mean, resampling);
  if (ratio.converged && std::abs(level.value) < 2 * level.error) {
    ratio.converged = false;
    ratio.reason = "the mean is not known to differ from zero: a ratio to it means nothing";
  }
  return ratio;
}

}  // namespace corpuscle::statistics
