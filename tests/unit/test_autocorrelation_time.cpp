// Correlation times, means and bootstrap errors of series whose correlations are known.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "physics/statistics/autocorrelation_time.hpp"
#include "physics/statistics/mean_error.hpp"
#include "physics/statistics/resample.hpp"
#include "tests/catch.hpp"
#include "tests/unit/synthetic_series.hpp"

using namespace corpuscle::statistics;
using namespace corpuscle::test;

TEST_CASE("autocorrelation_time: AR(1) within its own error", "[statistics]") {
  Normal normal(1);
  for (const double a : {0.0, 0.5, 0.9, 0.97}) {
    const double truth = 0.5 + a / (1 - a);
    const auto result = autocorrelation_time(ar1(a, 2, 100000, normal));
    CAPTURE(a, result.time, result.error);
    CHECK(result.window_closed);
    // Besides the statistical error the window of 5 tau cuts off exp(-5) of the sum.
    CHECK(std::abs(result.time - truth) < 4 * result.error + 0.007 * truth);
    CHECK(result.error < 0.1 * truth);
    CHECK(result.variance == Approx(1).margin(4 * std::sqrt(2 * (1 + a * a) / (1 - a * a) / 1e5)));  // Isserlis: 2 sum rho^2 / n
  }
}

TEST_CASE("autocorrelation_time: the error of tau covers it", "[statistics]") {
  Normal normal(2);
  Coverage coverage;
  for (int i = 0; i < 600; ++i) {
    const auto result = autocorrelation_time(ar1(0.8, 0, 5000, normal));
    coverage.add(result.time, result.error, 4.5);
  }
  CAPTURE(coverage.share(), coverage.error());
  CHECK(coverage.share() > 0.60);
  // The formula neglects that neighbouring lags err together: for AR(1) it is 12 % too large, on the safe side (74 %; binomial error 2 %).
  CHECK(coverage.share() < 0.80);
}

TEST_CASE("autocorrelation_time: gaps don't shorten the correlations", "[statistics]") {
  Normal normal(3);
  auto series = ar1(0.9, 0, 100000, normal);
  for (double& x : series) {
    if (normal.uniform() < 0.5) x = not_a_number;
  }
  const auto result = autocorrelation_time(series);
  CHECK(result.valid_samples == Approx(50000).epsilon(0.02));
  // Simply joining the samples that are left would give tau = 1/2 + sum_t (mean of a^s over the spacing s) = 5.
  CHECK(std::abs(result.time - 9.5) < 0.5);
  // The mean of every second sample is nearly as good as that of all: variance (1 + sum of the rest halved)/n.
  CHECK(result.mean_variance == Approx((1 + 0.5 * 18) / 50000).epsilon(0.06));
}

TEST_CASE("mean_estimate and block_mean: coverage of the error bars", "[statistics]") {
  Normal normal(4);
  for (const double a : {0.0, 0.8}) {
    Coverage by_time, by_blocks, with_gap;
    for (int i = 0; i < 500; ++i) {
      auto series = ar1(a, 7, 2000, normal);
      const auto mean = mean_estimate(series, 0.1);
      by_time.add(mean.value, mean.error, 7);
      const auto blocks = block_mean(series, 20, 0.1);
      by_blocks.add(blocks.value, blocks.error, 7);
      std::fill(series.begin() + 500, series.begin() + 900, not_a_number);
      const auto rest = mean_estimate(series, 0.1);
      with_gap.add(rest.value, rest.error, 7);
    }
    for (const auto& coverage : {by_time, by_blocks, with_gap}) {
      CAPTURE(a, coverage.share(), coverage.error());
      CHECK(coverage.share() > 0.60);
      CHECK(coverage.share() < 0.75);
    }
  }
  const double truth = 0.1 * 4.5;
  CHECK(mean_estimate(ar1(0.8, 0, 50000, normal), 0.1).correlation_time == Approx(truth).epsilon(0.15));
  CHECK(block_mean(ar1(0.8, 0, 50000, normal), 200, 0.1).correlation_time == Approx(truth).epsilon(0.4));  // error of 200 blocks' variance: 10 %
}

TEST_CASE("mean_estimate and block_mean: what cannot be trusted is said", "[statistics]") {
  CHECK(says(mean_estimate({}).reason, "no valid sample"));
  CHECK(says(block_mean({}).reason, "no valid sample"));
  CHECK(says(mean_estimate(std::vector<double>{1}).reason, "one sample"));
  CHECK(says(block_mean(std::vector<double>{1}).reason, "one block"));
  CHECK(says(block_mean(std::vector<double>{1, 2, 3}).reason, "too few"));
  Normal normal(5);
  const auto slow = ar1(0.995, 0, 1000, normal);
  CHECK_FALSE(mean_estimate(slow).converged);
  CHECK(says(mean_estimate(slow).reason, "correlation times"));
  CHECK(says(block_mean(slow).reason, "neighbouring"));
  const auto constant = block_mean(std::vector<double>(100, 0.1));
  CHECK(constant.value == Approx(0.1));
  CHECK(constant.error < 1e-15);
  CHECK(constant.converged);
  CHECK(std::isnan(constant.correlation_time));
}

TEST_CASE("bootstrap: the error of a mean is the analytic one, that of a curve carries its correlations", "[statistics]") {
  Normal normal(6);
  const Eigen::Index blocks = 25;
  BlockedCurve curve;
  curve.x = Eigen::Vector2d(0, 1);
  curve.sums = Eigen::MatrixXd(2, blocks);
  curve.counts = Eigen::MatrixXd::Ones(2, blocks);
  for (Eigen::Index b = 0; b < blocks; ++b) {
    curve.sums(0, b) = normal();
    curve.sums(1, b) = 3 * curve.sums(0, b);  // the same noise three times as large
  }
  const Eigen::VectorXd first = curve.sums.row(0);
  const double mean = first.mean();
  const double analytic = std::sqrt((first.array() - mean).square().sum() / (blocks * (blocks - 1.0)));
  const auto resampled = bootstrap(blocks, [&](const Eigen::VectorXd& w) { return curve.value(w); }, {4000, 3});
  CHECK(resampled.error[0] == Approx(analytic).epsilon(0.05));  // 1/sqrt(2*4000) = 1.1 %, 4 sigma
  CHECK(resampled.error[1] == Approx(3 * analytic).epsilon(0.05));
  CHECK(resampled.covariance(0, 1) == Approx(resampled.error[0] * resampled.error[1]));
  const auto difference = estimate_from(curve, [](const Eigen::VectorXd& y) { return y[1] - 3 * y[0]; });
  CHECK(difference.error < 1e-12);  // independent errors would give 4.2 times that of the first point
  CHECK(difference.converged);
}

TEST_CASE("bootstrap: coverage with few blocks, and what is refused", "[statistics]") {
  Normal normal(7);
  Coverage coverage;
  for (int i = 0; i < 400; ++i) {
    BlockedCurve curve;
    curve.x = Eigen::VectorXd::Zero(1);
    curve.sums = Eigen::MatrixXd(1, 10);
    curve.counts = Eigen::MatrixXd::Constant(1, 10, 2);
    for (Eigen::Index b = 0; b < 10; ++b) curve.sums(0, b) = 2 + normal();
    const auto result = with_errors(curve, {}, {200, static_cast<std::uint64_t>(i)});
    CHECK(result.converged);
    coverage.add(result.value[0], result.error[0], 1);
  }
  CAPTURE(coverage.share(), coverage.error());
  CHECK(coverage.share() > 0.60);  // Student's t with 9 degrees: 65.7 %
  CHECK(coverage.share() < 0.75);

  BlockedCurve one;
  one.x = Eigen::VectorXd::Zero(1);
  one.sums = one.counts = Eigen::MatrixXd::Ones(1, 1);
  CHECK(says(with_errors(one).reason, "too few"));
  CHECK(std::isnan(with_errors(one).error[0]));
  CHECK(says(estimate_from(one, [](const Eigen::VectorXd&) { return not_a_number; }).reason, "cannot be computed"));
  one.reason = "no cell";
  CHECK(estimate_from(one, [](const Eigen::VectorXd& y) { return y[0]; }).reason == "no cell");
  CHECK(block_count(1000, 5) == 20);
  CHECK(block_count(1000, 500) == 10);
  CHECK(block_count(1000, 0.5) == 32);
  CHECK(block_count(4, 1) == 4);
}
