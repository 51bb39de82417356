// What runs of a sweep tell together, from viscosities and variances made by known laws.
#include <cmath>

#include "physics/analysis/flow_curves.hpp"
#include "physics/statistics/dissipation.hpp"
#include "tests/catch.hpp"
#include "tests/unit/synthetic_series.hpp"

using namespace corpuscle;
using namespace corpuscle::test;
using analysis::RunOutcome;
using statistics::Estimate;

namespace {

Estimate known(double value, double error) { return {.value = value, .error = error, .effective_samples = 100, .converged = true}; }

/// sigma_y = 0.2 (phi - 0.6) above 0.6; 2 Ca^-1/2 besides; errors of 1 %.
std::vector<RunOutcome> matrix(const std::vector<double>& fractions, Normal& normal) {
  std::vector<RunOutcome> runs;
  for (const double phi : fractions) {
    for (const double capillary : {0.081, 0.0028, 0.028, 2.8e-4, 8.4e-5}) {  // not in order
      const double viscosity = std::max(0.2 * (phi - 0.6), 0.0) / capillary + 2 / std::sqrt(capillary);
      const double l = 2 * 2 * (std::cbrt(1 / phi) - 1) / 9;  // radii, r' = 2 at r = 9
      const double variance = ((viscosity - 1) / (1 - phi) - 1) * l * l;
      runs.push_back({.directory = "phi" + std::to_string(phi).substr(0, 4) + "-Ca" + std::to_string(capillary),
                      .capillary_number = capillary,
                      .phi_effective = phi * (1 + 1e-4 * (normal.uniform() - 0.5)),
                      .phi_geometric = 0.83 * phi,
                      .radius = 9,
                      .phi_bulk = phi,
                      .viscosity = known(viscosity * (1 + 0.01 * normal()), 0.01 * viscosity),
                      .velocity_variance = known(variance * (1 + 0.05 * normal()), 0.05 * variance)});
    }
  }
  return runs;
}

}  // namespace

TEST_CASE("flow curves: runs are gathered by volume fraction and ordered by capillary number", "[analysis]") {
  Normal normal(1);
  const auto curves = analysis::flow_curves(matrix({0.75, 0.45, 0.66}, normal));
  REQUIRE(curves.size() == 3);
  CHECK(curves[0].phi_effective == Approx(0.45).epsilon(2e-3));
  CHECK(curves[0].phi_geometric == Approx(0.83 * 0.45));
  REQUIRE(curves[0].runs.size() == 5);
  CHECK(curves[0].runs[0] == "phi0.45-Ca0.000084");
  CHECK(curves[0].runs[4] == "phi0.45-Ca0.081000");
  const auto exponent = curves[0].shear_thinning.parameter("exponent"), prefactor = curves[0].shear_thinning.parameter("prefactor");
  CHECK(std::abs(exponent.value - 0.5) < 4 * exponent.error);
  CHECK(std::abs(prefactor.value - 2) < 4 * prefactor.error);
  CHECK(curves[0].shear_thinning.converged);
  const auto yield = curves[2].yield_stress.parameter("yield_stress");
  CHECK(std::abs(yield.value - 0.03) < 4 * yield.error);
  CHECK(yield.value > 2 * yield.error);
}

TEST_CASE("flow curves: too few points, and such that aren't converged", "[analysis]") {
  Normal normal(2);
  auto runs = matrix({0.45}, normal);
  runs.pop_back();
  runs.pop_back();
  auto curves = analysis::flow_curves(runs);
  CHECK(curves.at(0).shear_thinning.converged);
  CHECK(says(curves[0].yield_stress.reason, "3 viscosities with errors are too few for this fit (at least 4)"));
  CHECK(std::isnan(curves[0].yield_stress.parameter("yield_stress").value));
  runs[0].viscosity.converged = false;
  curves = analysis::flow_curves(runs);
  CHECK_FALSE(curves[0].shear_thinning.converged);
  CHECK(says(curves[0].shear_thinning.reason, "phi0.45-Ca0.081"));
  CHECK(std::isfinite(curves[0].shear_thinning.parameter("exponent").value));
  runs[1].viscosity = {};
  curves = analysis::flow_curves(runs);
  CHECK(says(curves[0].shear_thinning.reason, "2 viscosities"));
  runs[2].capillary_number = 0;  // at rest: no point of a flow curve
  CHECK(analysis::flow_curves(runs)[0].runs.size() == 2);
  CHECK(analysis::flow_curves({}).empty());
}

TEST_CASE("critical volume fraction: where the yield stress vanishes", "[analysis]") {
  Coverage coverage;
  Normal normal(3);
  int refused = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto critical = analysis::critical_volume_fraction(analysis::flow_curves(matrix({0.45, 0.55, 0.7, 0.75, 0.8, 0.9}, normal)));
    REQUIRE(std::isfinite(critical.value));
    coverage.add(critical.value, critical.error, 0.6);
    refused += critical.converged ? 0 : 1;
  }
  check(coverage);
  CHECK(refused < 100);

  const auto two = analysis::critical_volume_fraction(analysis::flow_curves(matrix({0.45, 0.75, 0.9}, normal)));
  CHECK(two.value == Approx(0.6).margin(0.05));
  CHECK(says(two.reason, "two points"));
  const auto none = analysis::critical_volume_fraction(analysis::flow_curves(matrix({0.12, 0.24, 0.9}, normal)));
  CHECK(std::isnan(none.value));
  CHECK(says(none.reason, "1 of 3 volume fractions"));

  // A yield stress that falls has no critical fraction.
  std::vector<analysis::FlowCurve> falling(2);
  for (std::size_t i = 0; i < 2; ++i) {
    falling[i].phi_effective = 0.7 + 0.1 * static_cast<double>(i);
    falling[i].yield_stress = {.names = {"yield_stress"}, .parameters = Eigen::VectorXd::Constant(1, 1 - 0.5 * static_cast<double>(i)),
                               .errors = Eigen::VectorXd::Constant(1, 0.01), .converged = true};
  }
  CHECK(says(analysis::critical_volume_fraction(falling).reason, "doesn't grow"));
}

TEST_CASE("gap radius of a sweep in lattice spacings", "[analysis]") {
  Normal normal(4);
  const auto runs = matrix({0.12, 0.45, 0.55}, normal);
  auto fit = analysis::gap_radius(runs);
  REQUIRE(fit.converged);
  CHECK(fit.degrees_of_freedom == 9);  // those at 0.12 are too dilute
  CHECK(std::abs(fit.parameter("slope").value - 2) < 4 * fit.parameter("slope").error);
  CHECK(fit.parameter("slope").error < 0.1);
  auto doubtful = runs;
  doubtful[7].velocity_variance.converged = false;
  CHECK(says(analysis::gap_radius(doubtful).reason, doubtful[7].directory));
  CHECK(says(analysis::gap_radius({runs[6]}).reason, "two are needed"));
  CHECK(says(analysis::gap_radius({}).reason, "0 runs"));
}

TEST_CASE("variances of three directions add up with their errors", "[analysis]") {
  auto sum = analysis::total_variance({known(1, 0.1), known(2, 0.2), known(3, 0.3)});
  CHECK(sum.value == 6);
  CHECK(sum.error == Approx(0.6));
  CHECK(sum.converged);
  Estimate bad = known(1, 0.1);
  bad.converged = false;
  bad.reason = "short";
  sum = analysis::total_variance({known(1, 0.1), bad, known(3, 0.3)});
  CHECK_FALSE(sum.converged);
  CHECK(sum.reason == "short");
}
