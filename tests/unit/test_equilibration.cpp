// Where the start-up ends, for series whose transient is known.
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "physics/statistics/equilibration.hpp"
#include "tests/catch.hpp"
#include "tests/unit/synthetic_series.hpp"

using corpuscle::statistics::equilibration;
using namespace corpuscle::test;

TEST_CASE("equilibration: a decaying start-up is cut where it sinks into the noise", "[statistics]") {
  Normal normal(5);
  for (const double a : {0.0, 0.7}) {
    // x = 10 exp(-i/100) + noise of sd 1: cutting at d leaves a bias of about 1000 exp(-d/100)/(n-d), which equals the error of the mean,
    // sqrt(2 tau/n) = 0.02 to 0.05, near d = 250; and the start-up is 1e-3 of the noise at d = 920.
    for (int repetition = 0; repetition < 20; ++repetition) {
      auto series = ar1(a, 4, 3000, normal);
      for (std::size_t i = 0; i < series.size(); ++i) series[i] += 10 * std::exp(-static_cast<double>(i) / 100);
      const auto result = equilibration(series);
      CAPTURE(a, repetition, result.first);
      CHECK(result.converged);
      CHECK(result.first >= 150);
      CHECK(result.first <= 1500);
    }
  }
}

TEST_CASE("equilibration: little of a stationary series is lost", "[statistics]") {
  Normal normal(6);
  for (const double a : {0.0, 0.5, 0.9}) {
    double lost = 0;
    int failures = 0;
    for (int repetition = 0; repetition < 100; ++repetition) {
      const auto series = ar1(a, 1, 2000, normal);
      const auto result = equilibration(series);
      failures += result.converged ? 0 : 1;
      lost += static_cast<double>(result.first) / 2000 / 100;
    }
    CAPTURE(a, lost, failures);
    CHECK(lost < 0.25);
    CHECK(failures <= 15);
  }
}

TEST_CASE("equilibration: a run that never becomes steady is not converged", "[statistics]") {
  Normal normal(7);
  std::vector<double> ramp(1000), late(1000), slow(1000);
  for (std::size_t i = 0; i < ramp.size(); ++i) {
    ramp[i] = 0.01 * static_cast<double>(i) + 0.1 * normal();
    late[i] = (i < 700 ? 5 : 0) + normal();
    slow[i] = 10 * std::exp(-static_cast<double>(i) / 1000) + 0.1 * normal();
  }
  for (const auto& series : {ramp, late, slow}) {
    const auto result = equilibration(series);
    CHECK_FALSE(result.converged);
    CHECK(result.first == 500);
    CHECK(result.reason.find("run longer") != std::string::npos);
  }
}

TEST_CASE("equilibration: short, constant and broken series", "[statistics]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(equilibration({}).converged);
  CHECK(equilibration(std::vector<double>(20, 1.0)).reason.find("too few") != std::string::npos);
  CHECK_FALSE(equilibration(std::vector<double>(500, nan)).converged);
  for (const double value : {0.0, 0.1, 1e9}) {
    const auto constant = equilibration(std::vector<double>(500, value));
    CHECK(constant.converged);
    CHECK(constant.first == 0);
  }
  Normal normal(8);
  auto series = ar1(0.5, 0, 1000, normal);
  for (std::size_t i = 0; i < 100; ++i) series[i] += 20;
  for (std::size_t i = 300; i < 340; ++i) series[i] = nan;  // whole batches are missing: samples keep their numbers
  const auto result = equilibration(series);
  CHECK(result.converged);
  CHECK(result.first >= 100);
  CHECK(result.first < 500);
}
