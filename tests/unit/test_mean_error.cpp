// The mean's error bar against series whose correlations are known.
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "physics/statistics/mean_error.hpp"
#include "tests/catch.hpp"

using corpuscle::statistics::mean_error;

namespace {

/// Stationary AR(1) series x_i = a x_{i-1} + noise with variance 1 and mean `mean`: tau = 1/2 + a/(1-a).
std::vector<double> ar1(double a, double mean, std::size_t n, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<double> series(n);
  double x = normal(random);
  for (auto& value : series) {
    value = mean + x;
    x = a * x + std::sqrt(1 - a * a) * normal(random);
  }
  return series;
}

}  // namespace

TEST_CASE("mean_error: correlation time and error of AR(1) series", "[statistics]") {
  std::mt19937_64 random(7);
  for (const double a : {0.0, 0.5, 0.9}) {
    const double tau = 0.5 + a / (1 - a);
    const std::size_t n = 200000;
    const auto result = mean_error(ar1(a, 3, n, random));
    CHECK(result.correlation_time == Approx(tau).epsilon(0.05));
    CHECK(result.error == Approx(std::sqrt(2 * tau / static_cast<double>(n))).epsilon(0.05));
    CHECK(result.effective_samples == Approx(static_cast<double>(n) / (2 * tau)).epsilon(0.05));
    CHECK(std::abs(result.mean - 3) < 4 * result.error);
    CHECK(result.converged);
  }
}

TEST_CASE("mean_error: the error bar covers the true mean in two of three repetitions", "[statistics]") {
  std::mt19937_64 random(11);
  const int repetitions = 1000;
  for (const double a : {0.0, 0.6, 0.9}) {
    int covered = 0;
    for (int i = 0; i < repetitions; ++i) {
      const auto result = mean_error(ar1(a, -2, 600, random));
      covered += std::abs(result.mean + 2) < result.error ? 1 : 0;
    }
    const double coverage = static_cast<double>(covered) / repetitions;
    CAPTURE(a, coverage);
    CHECK(coverage > 0.60);
    CHECK(coverage < 0.75);
  }
}

TEST_CASE("mean_error: says when a series is too short to trust", "[statistics]") {
  std::mt19937_64 random(3);
  int trusted = 0;
  for (int i = 0; i < 200; ++i) trusted += mean_error(ar1(0.98, 0, 100, random)).converged ? 1 : 0;  // two correlation times
  CHECK(trusted < 30);  // chance lets a few of them look uncorrelated

  std::vector<double> ramp(1000);
  std::iota(ramp.begin(), ramp.end(), 0.0);
  CHECK_FALSE(mean_error(ramp).converged);
}

TEST_CASE("mean_error: few, equal and missing samples", "[statistics]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(std::isnan(mean_error({}).mean));
  CHECK(std::isnan(mean_error({}).error));
  CHECK_FALSE(mean_error({}).converged);

  const std::vector<double> one{2.5};
  CHECK(mean_error(one).mean == 2.5);
  CHECK(std::isnan(mean_error(one).error));

  const std::vector<double> equal(40, 0.1);
  CHECK(mean_error(equal).mean == Approx(0.1));
  CHECK(mean_error(equal).error == 0);
  CHECK(mean_error(equal).converged);

  const std::vector<double> with_gap{1, nan, 3, nan};
  CHECK(mean_error(with_gap).mean == 2);
  CHECK(mean_error(with_gap).error > 0);
  CHECK(std::isnan(mean_error(std::vector<double>(5, nan)).mean));
  CHECK_FALSE(mean_error(std::vector<double>(5, nan)).converged);
}

TEST_CASE("mean_error: an anti-correlated series has no error below zero", "[statistics]") {
  std::vector<double> alternating(1000);
  for (std::size_t i = 0; i < alternating.size(); ++i) alternating[i] = i % 2 == 0 ? 1 : -1;
  const auto result = mean_error(alternating);
  CHECK(result.mean == Approx(0).margin(1e-15));
  CHECK(result.error > 0);
  CHECK(result.error < 1 / std::sqrt(1000.0));
}
