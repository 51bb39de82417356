// Fits of synthetic data: values recovered, errors that cover the truth, and refusals.
#include <cmath>
#include <string>

#include "physics/statistics/correlation.hpp"
#include "physics/statistics/fit.hpp"
#include "tests/catch.hpp"
#include "tests/unit/synthetic_series.hpp"

using namespace corpuscle::statistics;
using namespace corpuscle::test;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

FitData noisy(const VectorXd& x, const VectorXd& truth, const VectorXd& error, Normal& normal) {
  FitData data{.x = x, .y = truth, .error = error};
  for (Index i = 0; i < x.size(); ++i) data.y[i] += error[i] * normal();
  return data;
}

}  // namespace

TEST_CASE("fit: exact data give exact parameters", "[statistics]") {
  const VectorXd x = VectorXd::LinSpaced(12, 0.2, 4);
  const auto fit_of = [&](const VectorXd& y) { return FitData{.x = x, .y = y, .error = VectorXd::Constant(x.size(), 0.1)}; };
  CHECK(fit_line(fit_of((3 - 0.5 * x.array()).matrix())).parameters.isApprox(Eigen::Vector2d(3, -0.5), 1e-12));
  CHECK(fit_proportional(fit_of(2 * x)).parameters[0] == Approx(2));
  CHECK(fit_power_law(fit_of((4 * x.array().pow(-0.5)).matrix())).parameters.isApprox(Eigen::Vector2d(4, -0.5), 1e-12));
  CHECK(fit_shear_thinning(fit_of((4 * x.array().pow(-0.5)).matrix())).parameters.isApprox(Eigen::Vector2d(4, 0.5), 1e-12));
  const auto stretched = fit_stretched_exponential(fit_of((2e-7 * (-(x.array() / 1.3).pow(0.7)).exp()).matrix()));
  CHECK(stretched.parameters.isApprox(Eigen::Vector3d(2e-7, 1.3, 0.7), 1e-6));
  const auto yield = fit_yield_stress(fit_of((0.01 / x.array() + 2 * x.array().pow(-0.45)).matrix()));
  CHECK(yield.parameters.isApprox(Eigen::Vector3d(0.01, 2, 0.45), 1e-5));
  CHECK(yield.chi2 == Approx(0).margin(1e-10));
  CHECK(yield.degrees_of_freedom == 9);
  CHECK(yield.parameter("exponent").value == Approx(0.45).epsilon(1e-4));
  CHECK(says(yield.parameter("slope").reason, "no parameter slope"));
}

TEST_CASE("fit: errors of a line are the textbook's, with known and unknown errors of the points", "[statistics]") {
  const VectorXd x = VectorXd::LinSpaced(5, -2, 2);  // sum x^2 = 10
  FitData data{.x = x, .y = 1 + 2 * x.array(), .error = VectorXd::Constant(5, 0.3)};
  data.y[1] += 0.1;
  data.y[3] -= 0.1;
  const auto known = fit_line(data);
  CHECK(known.errors[0] == Approx(0.3 / std::sqrt(5.0)));
  CHECK(known.errors[1] == Approx(0.3 / std::sqrt(10.0)));
  CHECK(known.covariance(0, 1) == Approx(0).margin(1e-15));
  // Residuals: the slope takes -0.02 x, which leaves 0.1 - 0.02 and twice 0.04.
  const double sum = 2 * 0.08 * 0.08 + 2 * 0.04 * 0.04;
  CHECK(known.chi2 == Approx(sum / 0.09));
  CHECK(known.probability > 0.9);
  data.error.resize(0);
  CHECK(fit_line(data).errors[1] == Approx(std::sqrt(sum / 3 / 10)));
  CHECK(std::isnan(fit_line(data).probability));
  // The general search gives the same as linear algebra.
  const auto searched = fit_model([](double u, const VectorXd& p) { return p[0] + p[1] * u; }, data, {.names = {"a", "b"}, .start = Eigen::Vector2d(0.3, 0.3)});
  CHECK(searched.parameters.isApprox(fit_line(data).parameters, 1e-7));
  CHECK(searched.errors.isApprox(fit_line(data).errors, 1e-6));
}

TEST_CASE("fit: coverage of the parameters' errors", "[statistics]") {
  Normal normal(1);
  const VectorXd t = VectorXd::LinSpaced(15, 0, 2.8), capillary = (Eigen::ArrayXd(7) << 0.081, 0.056, 0.028, 2.8e-3, 2.8e-4, 8.4e-5, 4.2e-5).finished();
  const VectorXd decay = 3 * (-(t.array() / 0.8).pow(1.3)).exp(), viscosity = 2e-3 / capillary.array() + 1.5 * capillary.array().pow(-0.5);
  Coverage time, exponent, stress, power, unknown;
  double probability = 0;
  for (int i = 0; i < 300; ++i) {
    const auto stretched = fit_stretched_exponential(noisy(t, decay, VectorXd::Constant(t.size(), 0.05), normal));
    REQUIRE(stretched.converged);
    time.add(stretched.parameters[1], stretched.errors[1], 0.8);
    exponent.add(stretched.parameters[2], stretched.errors[2], 1.3);
    probability += stretched.probability / 300;
    const auto yield = fit_yield_stress(noisy(capillary, viscosity, 0.02 * viscosity, normal));
    REQUIRE(yield.converged);
    stress.add(yield.parameters[0], yield.errors[0], 2e-3);
    power.add(yield.parameters[2], yield.errors[2], 0.5);
    FitData line = noisy(t, 1 + 2 * t.array(), VectorXd::Constant(t.size(), 0.4), normal);
    line.error.resize(0);
    const auto straight = fit_line(line);
    unknown.add(straight.parameters[1], straight.errors[1], 2);
  }
  for (const auto& coverage : {time, exponent, stress, power, unknown}) check(coverage);
  CHECK(probability == Approx(0.5).margin(4 * 0.29 / std::sqrt(300.0)));  // uniform when the model holds
}

TEST_CASE("fit: a correlated curve needs resampling", "[statistics]") {
  Normal normal(2);
  Coverage time, slope, naive;
  for (int i = 0; i < 200; ++i) {
    const auto v = ar1_matrix(std::exp(-0.1), 4000, 1, normal);
    const CorrelationOptions options{.longest_lag = 60, .removal = MeanRemoval::none, .blocks_of = Blocks::times, .blocks = 16};
    const Resampling resampling{60, static_cast<std::uint64_t>(i)};
    const auto decay = thinned(autocorrelation(v, 0.1, options), 3);
    const auto fit = fit_resampled(decay, [](const FitData& data) { return fit_stretched_exponential(data, 2.0); }, resampling);
    if (fit.converged) time.add(fit.parameters[1], fit.errors[1], 1);

    // Displacements in steps of the series: the points of an MSD go up and down together.
    const auto steps = ar1_matrix(0, 1000, 1, normal);
    Eigen::MatrixXd walk = steps;
    for (Index k = 1; k < walk.rows(); ++k) walk(k, 0) += walk(k - 1, 0);
    const auto msd = mean_square_displacement(walk, 1, {.longest_lag = 20, .removal = MeanRemoval::none, .blocks_of = Blocks::times, .blocks = 16});
    const auto line = fit_resampled(msd, fit_line, resampling);
    slope.add(line.parameters[1], line.errors[1], 1);
    const Curve points = with_errors(msd, {}, resampling);
    const auto direct = fit_line({.x = points.x, .y = points.value, .error = points.error});
    naive.add(direct.parameters[1], direct.errors[1], 1);
  }
  CHECK(time.tries >= 195);
  INFO(time.share() << " " << slope.share() << " " << naive.share());
  check(time);
  check(slope);
  CHECK(naive.share() < 0.5);
}

TEST_CASE("fit: what the data don't determine is said", "[statistics]") {
  const VectorXd x = VectorXd::LinSpaced(8, 1, 8), ones = VectorXd::Ones(8);
  CHECK(says(fit_line({.x = x.head(1), .y = ones.head(1), .error = {}}).reason, "too few"));
  CHECK(says(fit_line({.x = x.head(2), .y = ones.head(2), .error = {}}).reason, "without errors"));
  CHECK(says(fit_line({.x = ones, .y = x, .error = ones}).reason, "determine"));
  CHECK(says(fit_proportional({.x = 0 * x, .y = x, .error = ones}).reason, "depend on slope"));
  CHECK(says(fit_power_law({.x = x, .y = -ones, .error = ones}).reason, "too few"));
  CHECK(says(fit_stretched_exponential({.x = x, .y = -ones, .error = ones}).reason, "positive"));
  CHECK_FALSE(fit_stretched_exponential({.x = x, .y = ones, .error = 0.01 * ones}).converged);  // it never decays
  CHECK(says(fit_stretched_exponential({.x = x, .y = ones * not_a_number, .error = ones}).reason, "too few"));
  CHECK_FALSE(fit_yield_stress({.x = x.head(2), .y = ones.head(2), .error = ones.head(2)}).converged);
  // At one Ca only the sum is known.
  CHECK_FALSE(fit_yield_stress({.x = ones, .y = x, .error = ones}).converged);
  const auto gap = fit_line({.x = x, .y = (x.array() < 4 && x.array() > 2).select(ones * not_a_number, 2 * x), .error = ones});
  CHECK(gap.degrees_of_freedom == 5);
  CHECK(gap.parameters[1] == Approx(2));
  BlockedCurve nothing;
  nothing.reason = "no bulk region";
  CHECK(says(fit_resampled(nothing, fit_line).reason, "no bulk"));
}
