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
  CHECK(found.from == 3);
  CHECK(found.limit.converged);
  REQUIRE(found.terms.size() == 3);
  CHECK(found.terms[1].first == Approx(1.5).epsilon(1e-8));
  CHECK(found.terms[2].second == Approx(2).epsilon(1e-8));
  CHECK(found.model_error < 1e-10);
}

TEST_CASE("common limit: coarse resolutions outside of the series are left out", "[statistics]") {
  const CommonLimit found = common_limit(families(60));  // 12 % of the value at 3, 3 % at 4, 0.2 % at 8
  CHECK(found.from > 3);
  CHECK(std::abs(found.limit.value - 2) < 3 * found.limit.error);
  CHECK(found.limit.error < 0.03);
}

TEST_CASE("common limit: errors cover the truth", "[statistics]") {
  int inside = 0;
  const int repeats = 300;
  for (int i = 0; i < repeats; ++i) {
    const CommonLimit found = common_limit(families(0, 0.02, std::uint64_t(i + 1)));
    inside += std::abs(found.limit.value - 2) < found.statistical_error ? 1 : 0;
  }
  // 68 % of a normal distribution; the cut-off is chosen from the data now and then.
  CHECK(inside > 0.60 * repeats);
  CHECK(inside < 0.76 * repeats);
}

TEST_CASE("common limit: what can't be extrapolated", "[statistics]") {
  CHECK(common_limit({}).limit.reason.find("two resolutions") != std::string::npos);
  CHECK(std::isnan(common_limit({{5, 0, 1.0, 0.1}, {5, 1, 1.2, 0.1}}).limit.value));
  const CommonLimit two = common_limit({{4, 0, 2.25, 0.001}, {8, 0, 2.125, 0.001}});
  CHECK(two.limit.value == Approx(2));
  CHECK_FALSE(two.limit.converged);
  // Families that have nothing in common.
  auto values = families();
  for (auto& v : values)
    if (v.family == 1) v.value += 0.5;
  CHECK_FALSE(common_limit(values).limit.converged);
  // A family with one resolution takes no part, nor do values that are missing.
  values = families();
  values.push_back({6, 3, 17, 0.1});
  values.push_back({12, 0, std::nan(""), 0.1});
  const CommonLimit found = common_limit(values);
  CHECK(found.limit.value == Approx(2).epsilon(1e-9));
  CHECK(std::isnan(found.terms.at(3).first));
}
