// Densities, moments and fits of core and tails, for samples drawn from known distributions.
#include <cmath>
#include <numbers>
#include <string>

#include "physics/statistics/histogram.hpp"
#include "tests/catch.hpp"
#include "tests/unit/synthetic_series.hpp"

using namespace corpuscle::statistics;
using namespace corpuscle::test;
using Eigen::Index;
using Eigen::MatrixXd;

namespace {

/// Gaussian of width 1 within |x| < c, exponential beyond with the same value and slope (decay 1/c): Huber's least favourable density, by inversion of
/// the normal variables' distribution function so that correlations in time stay.
double huber(double gaussian, double c) {
  const double core = std::sqrt(2 * std::numbers::pi) * std::erf(c / std::numbers::sqrt2), tail = 2 / c * std::exp(-0.5 * c * c);
  const double u = std::erfc(std::abs(gaussian) / std::numbers::sqrt2) * (core + tail);  // integral beyond |x|, both sides
  if (u < tail) return std::copysign(-(std::log(u * c / 2) - 0.5 * c * c) / c, gaussian);
  double low = 0, high = c;
  for (int i = 0; i < 50; ++i) {
    const double x = 0.5 * (low + high), beyond = tail + core - std::sqrt(2 * std::numbers::pi) * std::erf(x / std::numbers::sqrt2);
    (beyond > u ? low : high) = x;
  }
  return std::copysign(low, gaussian);
}

}  // namespace

TEST_CASE("histogram: counts, range, gaps and blocks", "[statistics]") {
  MatrixXd x(4, 2);
  x << 0.1, 0.9, 0.5, -3, not_a_number, 1.0, 0.26, 0.24;
  const auto all = histogram(x, 0, 1, 4, 2);
  CHECK(all.counts.rowwise().sum() == Eigen::Vector4d(2, 1, 1, 1));  // the upper end lies outside
  CHECK(all.samples == Eigen::Vector2d(4, 3));
  CHECK(all.counts(0, 1) == 1);
  const auto density = probability_density(all);
  CHECK(density.value[0] == Approx(2 / (7 * 0.25)));
  CHECK(says(density.reason, "too few"));
  CHECK(says(histogram(x, 1, 1, 4).reason, "range"));
  CHECK(says(histogram(MatrixXd::Constant(5, 2, not_a_number), 0, 1, 4).reason, "no valid"));
  CHECK(says(histogram_around_mean(MatrixXd::Constant(5, 2, 0.1)).reason, "equal"));
  CHECK(says(probability_density(histogram_around_mean(MatrixXd(0, 0))).reason, "no valid"));
}

TEST_CASE("probability density and moments: coverage with correlated Gaussian samples", "[statistics]") {
  Normal normal(1);
  Coverage centre, flank, variance, skewness, kurtosis, mean, ratio;
  for (int i = 0; i < 800; ++i) {
    const MatrixXd x = 3 + 2 * ar1_matrix(0.7, 1500, 4, normal).array();
    const Resampling resampling{80, static_cast<std::uint64_t>(i)};
    const auto density = probability_density(histogram(x, -5, 11, 32), resampling);
    CHECK(density.converged);
    const auto truth = [&](Index bin) {
      const double low = (-8 + 0.5 * static_cast<double>(bin)) / (2 * std::numbers::sqrt2), high = low + 0.25 / std::numbers::sqrt2;
      return (std::erf(high) - std::erf(low)) / 2 / 0.5;
    };
    centre.add(density.value[16], density.error[16], truth(16));
    flank.add(density.value[10], density.error[10], truth(10));
    const auto m = moments(x, 0, resampling);
    const auto relative = relative_fluctuation(x, 0, resampling);
    ratio.add(relative.value, relative.error, 2.0 / 3);
    mean.add(m.mean.value, m.mean.error, 3);
    variance.add(m.variance.value, m.variance.error, 4);
    skewness.add(m.skewness.value, m.skewness.error, 0);
    kurtosis.add(m.excess_kurtosis.value, m.excess_kurtosis.error, 0);
  }
  for (const auto& coverage : {centre, flank, mean, variance, skewness, kurtosis, ratio}) check(coverage);
}

TEST_CASE("moments: known distributions and degenerate samples", "[statistics]") {
  Normal normal(2);
  MatrixXd exponential(20000, 1), laplace(20000, 1);
  for (Index i = 0; i < exponential.rows(); ++i) {
    exponential(i, 0) = -std::log1p(-normal.uniform());
    laplace(i, 0) = -std::log1p(-normal.uniform()) * (normal.uniform() < 0.5 ? -1 : 1);
  }
  const auto one = moments(exponential), two = moments(laplace);
  const auto within = [](const Estimate& estimate, double truth) { return estimate.converged && std::abs(estimate.value - truth) < 4 * estimate.error; };
  CHECK(within(one.mean, 1));
  CHECK(within(one.variance, 1));
  CHECK(within(one.skewness, 2));
  CHECK(within(one.excess_kurtosis, 6));
  CHECK(within(two.variance, 2));
  CHECK(within(two.skewness, 0));
  CHECK(within(two.excess_kurtosis, 3));

  const auto constant = moments(MatrixXd::Constant(100, 2, 0.3));
  CHECK(constant.mean.value == Approx(0.3));
  CHECK(constant.variance.value == Approx(0).margin(1e-15));
  CHECK(std::isnan(constant.skewness.value));
  CHECK(says(constant.excess_kurtosis.reason, "no shape"));
  CHECK(relative_fluctuation(MatrixXd::Constant(100, 2, 0.3)).value == Approx(0).margin(1e-12));
  CHECK(says(relative_fluctuation(MatrixXd::Zero(100, 2)).reason, "cannot be computed"));
  CHECK(says(relative_fluctuation(laplace).reason, "zero"));
  CHECK(says(moments(MatrixXd(10, 0)).mean.reason, "no valid"));
  CHECK(says(moments(MatrixXd::Random(3, 2)).variance.reason, "too few"));
}

TEST_CASE("core and tails: a Gaussian core with exponential tails is taken apart", "[statistics]") {
  Normal normal(3);
  const double c = 1.2;
  Coverage width, decay, height;
  double share = 0;
  const int repetitions = 200;
  for (int i = 0; i < repetitions; ++i) {
    MatrixXd x = ar1_matrix(0.5, 1200, 4, normal);
    for (Index k = 0; k < x.size(); ++k) x.data()[k] = 1 + 2 * huber(x.data()[k], c);
    // The density's standard deviation is 2 x 1.31 (c = 1.2), core_reach 0.9 of it stays within the core, tails start at 1.5: within the tail.
    const auto fit = fit_core_and_tails(histogram(x, -19, 21, 100), 0.9, 1.5, {40, static_cast<std::uint64_t>(i)});
    REQUIRE(fit.core.converged);
    REQUIRE(fit.upper.converged);
    REQUIRE(fit.lower.converged);
    width.add(fit.core.parameters[2], fit.core.errors[2], 2);
    decay.add(fit.upper.parameters[1], fit.upper.errors[1], 2 / c);
    decay.add(fit.lower.parameters[1], fit.lower.errors[1], 2 / c);
    const double norm = std::sqrt(2 * std::numbers::pi) * std::erf(c / std::numbers::sqrt2) + 2 / c * std::exp(-0.5 * c * c);
    height.add(fit.core.parameters[0], fit.core.errors[0], 1 / (2 * norm));
    share += fit.gaussian_tail / repetitions;
  }
  for (const auto& coverage : {width, decay, height}) check(coverage);
  CHECK(share < 0.7);  // more samples than the Gaussian would have

  const auto gaussian = fit_core_and_tails(histogram_around_mean(ar1_matrix(0, 20000, 1, normal)));
  CHECK(std::abs(gaussian.core.parameter("width").value - 1) < 4 * gaussian.core.parameter("width").error);
  CHECK(gaussian.gaussian_tail == Approx(1).epsilon(0.3));  // 900 samples, and the core's width is known to 2 %, which the tail takes fivefold
}

TEST_CASE("core and tails: what cannot be fitted is said", "[statistics]") {
  Normal normal(4);
  const auto few = fit_core_and_tails(histogram(ar1_matrix(0, 40, 1, normal), -6, 6, 60));
  CHECK(says(few.upper.reason, "too few"));
  CHECK(std::isnan(few.upper.parameters[1]));
  const auto none = fit_core_and_tails(histogram(MatrixXd::Constant(5, 2, not_a_number), 0, 1, 4));
  CHECK(says(none.core.reason, "no valid"));
  CHECK(says(fit_core_and_tails(histogram(MatrixXd::Ones(50, 2), 2, 3, 4)).lower.reason, "no sample"));
  CHECK_FALSE(fit_core_and_tails(histogram(MatrixXd::Ones(50, 2), 0, 3, 30)).core.converged);
}
