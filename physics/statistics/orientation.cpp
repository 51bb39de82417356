#include "physics/statistics/orientation.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "physics/statistics/resample.hpp"

namespace corpuscle::statistics {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double pi = std::numbers::pi;

// Sums over all cells of what `terms` gives for one sample, per stretch of time.
template <class Terms>
BlockedCurve sums_over_time(Index times, Index cells, Index blocks, Index numbers, const Terms& terms) {
  BlockedCurve curve;
  const Index count = std::clamp<Index>(blocks, 1, std::max<Index>(times, 1));
  curve.x = VectorXd::LinSpaced(numbers, 0, static_cast<double>(numbers - 1));
  curve.sums = curve.counts = Eigen::MatrixXd::Zero(numbers, count);
  for (Index cell = 0; cell < cells; ++cell) {
    for (Index b = 0; b < count; ++b) {
      for (Index t = b * times / count; t < (b + 1) * times / count; ++t) {
        const VectorXd term = terms(t, cell);
        if (term.array().isNaN().any()) continue;
        curve.sums.col(b) += term;
        curve.counts.col(b).array() += 1;
      }
    }
  }
  if (curve.counts.sum() <= 0) curve.reason = "there is no valid sample";
  return curve;
}

Eigen::Matrix3d tensor_of(const VectorXd& six) {
  Eigen::Matrix3d tensor;
  tensor << six[0], six[3], six[4], six[3], six[1], six[5], six[4], six[5], six[2];
  return tensor;
}

double wrapped(double angle) { return angle - pi * std::round(angle / pi); }  // into [-pi/2, pi/2]

}  // namespace

Orientation orientation(const AxisSeries& axes, Index blocks, const Resampling& resampling) {
  const BlockedCurve curve = sums_over_time(axes.x.rows(), axes.x.cols(), blocks, 6, [&](Index t, Index cell) {
    const double x = axes.x(t, cell), y = axes.y(t, cell), z = axes.z(t, cell);
    VectorXd six(6);
    six << x * x, y * y, z * z, x * y, x * z, y * z;
    return six;
  });
  Orientation result;
  result.tensor.setConstant(not_a_number);
  result.tensor_error = result.tensor;
  result.director.setConstant(not_a_number);
  result.order = estimate_from(
      curve,
      [](const VectorXd& six) {
        if (six.array().isNaN().any()) return not_a_number;
        return 1.5 * Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(tensor_of(six), Eigen::EigenvaluesOnly).eigenvalues()[2] - 0.5;
      },
      resampling);
  if (!curve.reason.empty()) return result;
  const Curve tensor = with_errors(curve, {}, resampling);
  result.tensor = tensor_of(tensor.value);
  result.tensor_error = tensor_of(tensor.error);
  result.director = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(result.tensor).eigenvectors().col(2);
  return result;
}

AxialMean axial_mean(const SeriesMatrix& angles, Index blocks, const Resampling& resampling) {
  const BlockedCurve curve = sums_over_time(angles.rows(), angles.cols(), blocks, 2, [&](Index t, Index cell) {
    return VectorXd(Eigen::Vector2d(std::cos(2 * angles(t, cell)), std::sin(2 * angles(t, cell))));
  });
  AxialMean result;
  result.resultant = estimate_from(curve, [](const VectorXd& m) { return m.norm(); }, resampling);
  result.angle.reason = curve.reason;
  if (!curve.reason.empty()) return result;
  const VectorXd all = curve.value();
  const double centre = 0.5 * std::atan2(all[1], all[0]);
  // Resamples are compared with the mean modulo pi, so that one near pi/2 doesn't scatter by pi.
  result.angle = estimate_from(curve, [&](const VectorXd& m) { return centre + wrapped(0.5 * std::atan2(m[1], m[0]) - centre); }, resampling);
  if (result.angle.converged && result.resultant.value < 3 * result.resultant.error) {
    result.angle.converged = false;
    result.angle.reason = "the angles have no preferred direction";
  }
  return result;
}

MotionShares motion_shares(const AxisSeries& axes, double time_step, double window, const Resampling& resampling) {
  constexpr double near_vorticity = 0.75, often = 0.01;
  const Index times = axes.x.rows(), cells = axes.x.cols();
  Index length = window > 0 ? static_cast<Index>(std::lround(window / time_step)) : times - 1;
  MotionShares result;
  const auto refuse = [&](const std::string& reason) {
    for (Estimate* estimate : {&result.tumbling, &result.steady, &result.rolling, &result.half_turns}) estimate->reason = reason;
    return result;
  };
  if (cells < 1) return refuse("there is no cell");
  if (length < 2 || length > times - 1) {
    return refuse(fmt::format("a window of {} intervals doesn't fit into {} samples (at least 2 intervals)", length, times));
  }
  const Index windows = (times - 1) / length;
  const bool over_time = windows >= blocks_to_trust;
  const Index blocks = over_time ? std::min<Index>(windows, 32) : std::min<Index>(cells, 32);

  BlockedCurve shares, turns;
  shares.sums = shares.counts = Eigen::MatrixXd::Zero(3, blocks);
  turns.sums = turns.counts = Eigen::MatrixXd::Zero(1, blocks);
  double steps = 0, large = 0;
  for (Index cell = 0; cell < cells; ++cell) {
    for (Index w = 0; w < windows; ++w) {
      double vorticity = 0, valid = 0, turned = 0, previous = not_a_number, wide = 0;
      for (Index t = w * length; t <= (w + 1) * length; ++t) {
        const double x = axes.x(t, cell), y = axes.y(t, cell), z = axes.z(t, cell);
        if (std::isnan(x + y + z)) continue;
        vorticity += y * y;
        valid += 1;
        const double angle = std::atan2(z, x);
        if (!std::isnan(previous)) {
          const double step = wrapped(angle - previous);
          turned += step;
          wide += std::abs(step) > pi / 4 ? 1 : 0;
        }
        previous = angle;
      }
      if (valid < 3) continue;
      const Index b = over_time ? w * blocks / windows : cell * blocks / cells;
      const bool rolling = vorticity > near_vorticity * valid, tumbling = !rolling && std::abs(turned) >= pi;
      shares.counts.col(b).array() += 1;
      shares.sums(rolling ? 2 : tumbling ? 0 : 1, b) += 1;
      if (tumbling) {
        turns.sums(0, b) += std::abs(turned) / pi;
        turns.counts(0, b) += static_cast<double>(length) * time_step;
      }
      if (!rolling) {
        steps += valid - 1;
        large += wide;
      }
    }
  }
  if (shares.counts.sum() <= 0) return refuse("there is no valid sample");
  if (turns.counts.sum() <= 0) turns.reason = "no cell tumbles";
  result.tumbling = estimate_from(shares, [](const VectorXd& s) { return s[0]; }, resampling);
  result.steady = estimate_from(shares, [](const VectorXd& s) { return s[1]; }, resampling);
  result.rolling = estimate_from(shares, [](const VectorXd& s) { return s[2]; }, resampling);
  result.half_turns = estimate_from(turns, [](const VectorXd& s) { return s[0]; }, resampling);
  if (large > often * steps) {
    const std::string reason = fmt::format("the axis turns by more than 45 degrees in {:.0f} % of the intervals: sample more often", 100 * large / steps);
    for (Estimate* estimate : {&result.tumbling, &result.steady, &result.half_turns}) {
      if (!estimate->converged) continue;
      estimate->converged = false;
      estimate->reason = reason;
    }
  }
  return result;
}

}  // namespace corpuscle::statistics
