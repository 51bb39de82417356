#include "physics/statistics/profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace corpuscle::statistics {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool fits(const SeriesMatrix& heights, const SeriesMatrix& quantity, const ProfileOptions& options, BlockedCurve& curve) {
  if (heights.rows() != quantity.rows() || heights.cols() != quantity.cols()) {
    curve.reason = fmt::format("heights and quantity have different shapes: {} x {} and {} x {}", heights.rows(), heights.cols(), quantity.rows(),
                               quantity.cols());
  } else if (heights.size() == 0) {
    curve.reason = "there is no sample";
  } else if (!(options.high > options.low) || options.bins < 1) {
    curve.reason = fmt::format("{} bins from {:g} to {:g} are no profile", options.bins, options.low, options.high);
  }
  return curve.reason.empty();
}

// Sums and numbers of valid values per bin and block.
BlockedCurve binned(const SeriesMatrix& heights, const SeriesMatrix& quantity, const ProfileOptions& options) {
  BlockedCurve curve;
  if (!fits(heights, quantity, options, curve)) return curve;
  const Index bins = options.bins, times = heights.rows(), blocks = std::clamp<Index>(options.blocks, 1, times);
  const double width = (options.high - options.low) / static_cast<double>(bins);
  curve.x = VectorXd::LinSpaced(bins, options.low + width / 2, options.high - width / 2);
  curve.sums = curve.counts = MatrixXd::Zero(bins, blocks);
  for (Index cell = 0; cell < heights.cols(); ++cell) {
    for (Index b = 0; b < blocks; ++b) {
      for (Index t = b * times / blocks; t < (b + 1) * times / blocks; ++t) {
        const double bin = std::floor((heights(t, cell) - options.low) / width), value = quantity(t, cell);
        if (!(bin >= 0 && bin < static_cast<double>(bins)) || std::isnan(value)) continue;
        curve.sums(static_cast<Index>(bin), b) += value;
        curve.counts(static_cast<Index>(bin), b) += 1;
      }
    }
  }
  if (curve.counts.sum() <= 0) curve.reason = fmt::format("no cell lies between {:g} and {:g}", options.low, options.high);
  return curve;
}

}  // namespace

BlockedCurve profile(const SeriesMatrix& heights, const SeriesMatrix& quantity, const ProfileOptions& options) {
  return binned(heights, quantity, options);
}

BlockedCurve density_profile(const SeriesMatrix& heights, const SeriesMatrix& quantity, double area, const ProfileOptions& options) {
  BlockedCurve curve = binned(heights, quantity, options);
  if (!curve.reason.empty()) return curve;
  if (!(area > 0)) {
    curve.reason = fmt::format("an area of {:g} has no density", area);
    return curve;
  }
  // Per time that has a valid sample at all: a gap in the series isn't an empty channel.
  const double volume = area * (options.high - options.low) / static_cast<double>(options.bins);
  const Index times = heights.rows(), blocks = curve.blocks();
  for (Index b = 0; b < blocks; ++b) {
    double present = 0;
    for (Index t = b * times / blocks; t < (b + 1) * times / blocks; ++t) {
      bool any = false;
      for (Index cell = 0; cell < heights.cols() && !any; ++cell) any = !std::isnan(heights(t, cell)) && !std::isnan(quantity(t, cell));
      present += any ? 1 : 0;
    }
    curve.counts.col(b).setConstant(present * volume);
  }
  return curve;
}

MatrixXd fluctuations(const SeriesMatrix& heights, const SeriesMatrix& velocities, const Curve& mean_flow) {
  std::vector<double> z, u;
  for (Index i = 0; i < mean_flow.x.size(); ++i) {
    if (std::isnan(mean_flow.value[i])) continue;
    z.push_back(mean_flow.x[i]);
    u.push_back(mean_flow.value[i]);
  }
  MatrixXd result = MatrixXd::Constant(velocities.rows(), velocities.cols(), not_a_number);
  if (z.size() < 2 || heights.rows() != velocities.rows() || heights.cols() != velocities.cols()) return result;
  for (Index cell = 0; cell < velocities.cols(); ++cell) {
    for (Index t = 0; t < velocities.rows(); ++t) {
      const double at = heights(t, cell);
      if (std::isnan(at)) continue;
      const auto above = std::upper_bound(z.begin(), z.end(), at) - z.begin();
      const auto i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(above, 1, static_cast<std::ptrdiff_t>(z.size()) - 1));
      result(t, cell) = velocities(t, cell) - (u[i - 1] + (u[i] - u[i - 1]) * (at - z[i - 1]) / (z[i] - z[i - 1]));
    }
  }
  return result;
}

MatrixXd fluctuations(const SeriesMatrix& heights, const SeriesMatrix& velocities, double shear_rate, double centre) {
  return velocities.array() - shear_rate * (heights.array() - centre);
}

MatrixXd within(const SeriesMatrix& heights, double low, double high) {
  const MatrixXd ones = MatrixXd::Ones(heights.rows(), heights.cols());
  return (heights.array() >= low && heights.array() <= high).select(ones, not_a_number);
}

}  // namespace corpuscle::statistics
