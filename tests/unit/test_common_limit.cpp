// Extrapolation of several families to one limit: exact series, noise with known errors, and data that don't allow it.
#include <cmath>

#include "physics/statistics/common_limit.hpp"
#include "tests/catch.hpp"
#include "tests/unit/synthetic_series.hpp"

using namespace corpuscle::statistics;
using corpuscle::test::Normal;

namespace {

std::vector<ResolvedValue> families(double third = 0, double noise = 0, std::uint64_t seed = 1) {
  Normal normal(seed);
  std::vector<ResolvedValue> values;
  const double first[3] = {0.9, 1.5, -0.4}, second[3] = {0.3, -1, 2};
  for (int f = 0; f < 3; ++f)
    for (const double r : {3.0, 4.0, 5.0, 6.0, 8.0, 10.0})
      values.push_back({r, f, 2 + first[f] / r + second[f] / (r * r) + third / std::pow(r, 5) + noise * normal(), noise});
  return values;
}

}  // namespace

TEST_CASE("common limit: an exact series", "[statistics]") {
  const CommonLimit found = common_limit(families());
  CHECK(found.limit.value == Approx(2).epsilon(1e-10));
  CHECK(found.limit.converged);
  CHECK(found.degrees_of_freedom == 2);
  REQUIRE(found.families.size() == 3);
  CHECK(found.families[1].from == 3);
  CHECK(found.families[1].first == Approx(1.5).epsilon(1e-8));
  CHECK(found.families[2].second == Approx(2).epsilon(1e-8));
  CHECK(found.families[1].model_error == Approx(0.25 * std::abs(1.5 / 10 - 1.0 / 100)));  // nothing changes without the coarsest
}

TEST_CASE("common limit: coarse resolutions outside of the series are left out", "[statistics]") {
  const CommonLimit found = common_limit(families(60));  // 12 % of the value at 3, 3 % at 4, 0.2 % at 8
  for (const auto& family : found.families) CHECK(family.from > 3);
  CHECK(std::abs(found.limit.value - 2) < 3 * found.limit.error);
  CHECK(found.limit.error < 0.03);
}

TEST_CASE("common limit: a family that hardly depends on the resolution decides", "[statistics]") {
  std::vector<ResolvedValue> values;
  for (const double r : {3.0, 4.0, 5.0, 6.0}) {
    values.push_back({r, 0, 1.6 + 0.1 / r, 0.01});
    values.push_back({r, 1, 1.6 + 2 / r + 3 / (r * r) + 20 / (r * r * r), 0.01});
  }
  const CommonLimit found = common_limit(values);
  CHECK(found.families[1].limit.error > 3 * found.families[0].limit.error);
  CHECK(std::abs(found.limit.value - 1.6) < 0.05);
}

TEST_CASE("common limit: errors cover the truth", "[statistics]") {
  int inside = 0;
  const int repeats = 300;
  for (int i = 0; i < repeats; ++i) {
    const CommonLimit found = common_limit(families(0, 0.02, std::uint64_t(i + 1)));
    inside += std::abs(found.limit.value - 2) < found.limit.error ? 1 : 0;
  }
  // At least the 68 % of a normal distribution: the model's part makes the error larger where only noise makes the limit change.
  CHECK(inside > 0.60 * repeats);  // 68 % and three times its error of 2.7 %
  CHECK(inside < 0.99 * repeats);
}

TEST_CASE("common limit: what can't be extrapolated", "[statistics]") {
  CHECK(common_limit({}).limit.reason.find("three resolutions") != std::string::npos);
  CHECK(std::isnan(common_limit({{5, 0, 1.0, 0.1}, {6, 0, 1.0, 0.1}, {5, 1, 1.2, 0.1}}).limit.value));
  // Families that have nothing in common.
  auto values = families();
  for (auto& v : values)
    if (v.family == 1) v.value += 0.5;
  CHECK(common_limit(values).limit.reason.find("contradict") != std::string::npos);
  // A family with one resolution takes no part, nor do values that are missing.
  values = families();
  values.push_back({6, 3, 17, 0.1});
  values.push_back({12, 0, std::nan(""), 0.1});
  const CommonLimit found = common_limit(values);
  CHECK(found.limit.value == Approx(2).epsilon(1e-9));
  CHECK(std::isnan(found.families.at(3).limit.value));
  // Noise that hides everything.
  const CommonLimit noisy = common_limit({{4, 0, 2, 1}, {6, 0, 1.5, 1}, {8, 0, 2.5, 1}});
  CHECK(noisy.limit.reason.find("its error is") != std::string::npos);
}
