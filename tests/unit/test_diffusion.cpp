// Diffusion coefficients of Ornstein-Uhlenbeck walkers three ways, and the gap between cells.
#include <cmath>
#include <string>
#include <vector>

#include "physics/statistics/correlation.hpp"
#include "physics/statistics/diffusion.hpp"
#include "physics/statistics/dissipation.hpp"
#include "tests/catch.hpp"
#include "tests/unit/synthetic_series.hpp"

using namespace corpuscle::statistics;
using namespace corpuscle::test;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double interval = 0.1;  // in correlation times

/// Positions after steps of `interval`: the rectangle rule, of which the trapezoidal sum over C(t) is the exact D: dt (1+a)/(1-a)/2.
MatrixXd positions_of(const MatrixXd& velocities) {
  MatrixXd x = interval * velocities;
  for (Index i = 1; i < x.rows(); ++i) x.row(i) += x.row(i - 1);
  return x;
}

CorrelationOptions lags(Index longest, Index blocks = 16) {
  return {.longest_lag = longest, .removal = MeanRemoval::none, .blocks_of = Blocks::times, .blocks = blocks};
}

/// A curve without noise.
BlockedCurve exact(const VectorXd& x, const VectorXd& y) {
  BlockedCurve curve;
  curve.x = x;
  curve.sums = y.replicate(1, 10);
  curve.counts = MatrixXd::Ones(x.size(), 10);
  return curve;
}

Estimate known(double value, double error) {
  return {.value = value, .error = error, .correlation_time = 0, .effective_samples = 100, .converged = true, .reason = {}};
}

}  // namespace

TEST_CASE("diffusion: three ways agree with an Ornstein-Uhlenbeck process within error bars that cover it", "[statistics]") {
  Normal normal(1);
  const double a = std::exp(-interval), truth = interval * (1 + a) / (1 - a) / 2;
  Coverage slope, integral, formula, relaxation;
  int refused = 0;
  const int repetitions = 200;
  for (int i = 0; i < repetitions; ++i) {
    const MatrixXd v = ar1_matrix(a, 4800, 3, normal);
    const Resampling resampling{60, static_cast<std::uint64_t>(i)};
    const auto vacf = autocorrelation(v, interval, lags(100));
    const auto msd = mean_square_displacement(positions_of(v), interval, lags(100));
    const auto from_msd = diffusion_from_msd(msd, 5, 10, resampling), from_vacf = diffusion_from_vacf(vacf, 0, resampling);
    const auto stretched = diffusion_from_stretched_exponential(thinned(vacf, 4), 2.5, resampling);
    slope.add(from_msd.value, from_msd.error, truth);
    integral.add(from_vacf.value, from_vacf.error, truth * (1 - std::exp(-6.0)));
    const auto time = relaxation_time(vacf, 0, resampling);
    relaxation.add(time.value, time.error, truth * (1 - std::exp(-6.0)));
    formula.add(stretched.diffusion.value, stretched.diffusion.error, 1);
    refused += (from_vacf.converged ? 0 : 1) + (stretched.diffusion.converged ? 0 : 1);
    CHECK(from_vacf.correlation_time == Approx(1).epsilon(0.5));
    CHECK(std::abs(from_msd.value - from_vacf.value) < 4 * std::hypot(from_msd.error, from_vacf.error));
  }
  for (const auto& coverage : {slope, integral, formula, relaxation}) check(coverage);
  CHECK(refused < repetitions / 50);
}

TEST_CASE("diffusion: ballistic, diffusive and subdiffusive displacements", "[statistics]") {
  const VectorXd t = VectorXd::LinSpaced(101, 0, 10);
  const auto diffusive = diffusion_from_msd(exact(t, (2 * 0.05 * (t.array() - 0.3)).matrix()), 5, 10);
  CHECK(diffusive.converged);
  CHECK(diffusive.value == Approx(0.05));
  CHECK(says(diffusion_from_msd(exact(t, t.cwiseAbs2()), 5, 10).reason, "isn't linear"));
  CHECK(says(diffusion_from_msd(exact(t, t.array().pow(1.7).matrix()), 5, 10).reason, "isn't linear"));
  CHECK(says(diffusion_from_msd(exact(t, 0 * t), 5, 10).reason, "doesn't grow"));
  CHECK(says(diffusion_from_msd(exact(t, t), 5, 5.1).reason, "too few"));
  BlockedCurve nothing;
  nothing.reason = "there is no particle";
  CHECK(says(diffusion_from_msd(nothing).reason, "no particle"));
  CHECK(says(diffusion_from_vacf(nothing).reason, "no particle"));
  CHECK(says(diffusion_from_stretched_exponential(nothing, 1).diffusion.reason, "no particle"));

  Normal normal(2);
  const MatrixXd v = ar1_matrix(0.9, 200, 2, normal);
  const auto msd = mean_square_displacement(positions_of(v), interval, lags(100));
  CHECK_FALSE(diffusion_from_msd(msd, 5, 10).converged);  // blocks of 12 samples, lags of 50 to 100
}

TEST_CASE("diffusion: integral of the velocity correlation and the Gamma formula", "[statistics]") {
  const VectorXd t = VectorXd::LinSpaced(2001, 0, 20);
  for (const double b : {0.8, 1.0, 1.5, 2.0}) {
    const VectorXd c = 3 * (-t.array().pow(b)).exp();
    const double truth = 3 * std::tgamma(1 + 1 / b);
    const auto integral = diffusion_from_vacf(exact(t, c), 20);
    CAPTURE(b);
    CHECK(integral.converged);
    CHECK(relaxation_time(exact(t, c), 20).value == Approx(integral.value / 3));
    CHECK(integral.value == Approx(truth).epsilon(3e-3));  // b = 0.8: the cusp at 0 costs the trapezoidal rule most
    const auto noise = exact(t, c);
    BlockedCurve noisy = noise;
    Normal normal(3);
    for (Index k = 0; k < noisy.sums.size(); ++k) noisy.sums.data()[k] += 1e-3 * normal();
    const auto formula = diffusion_from_stretched_exponential(thinned(noisy, 8), 2.0);
    CHECK(formula.diffusion.converged);
    CHECK(std::abs(formula.diffusion.value - truth) < 4 * formula.diffusion.error);
    CHECK(formula.diffusion.error < 0.01 * truth);
    CHECK(std::abs(formula.fit.parameter("exponent").value - b) < 4 * formula.fit.parameter("exponent").error);
  }
  const VectorXd slow = (-t.array() / 10).exp();
  CHECK(says(diffusion_from_vacf(exact(t, slow)).reason, "cut short"));
  CHECK(says(diffusion_from_vacf(exact(t, (-t.array() * 200).exp().matrix())).reason, "too far apart"));
  CHECK(says(diffusion_from_vacf(exact(t, 0 * t)).reason, "nothing fluctuates"));
  // Negative overshoot: C = exp(-t) (1 - t) has no diffusion at all.
  const auto caged = diffusion_from_vacf(exact(t, ((-t.array()).exp() * (1 - t.array())).matrix()), 20);
  CHECK(caged.value == Approx(0).margin(1e-4));
}

TEST_CASE("gap size: the balance and its radius", "[statistics]") {
  // Variances made from l = 2 r' (phi^(-1/3) - 1), r' = 2, and given viscosities.
  Normal normal(4);
  const std::vector<double> fractions{0.12, 0.24, 0.35, 0.45, 0.55, 0.66}, viscosities{1.35, 2.0, 2.9, 4.5, 7, 15};
  Coverage coverage;
  for (int i = 0; i < 300; ++i) {
    std::vector<DissipationState> states;
    for (std::size_t k = 0; k < fractions.size(); ++k) {
      const double phi = fractions[k], l = (phi < 0.2 ? 3 : 2) * 2 * (std::pow(phi, -1.0 / 3) - 1), rate = 1e-4;
      const double variance = rate * rate * l * l * std::abs((viscosities[k] - 1) / (1 - phi) - 1);  // below zero in the first state
      states.push_back({phi, rate, known(variance * (1 + 0.05 * normal()), 0.05 * variance),
                        known(viscosities[k] + 0.01 * normal(), 0.01)});
    }
    CHECK(std::isnan(gap_size(states[0]).value));  // 1.35 < 2 - 0.12
    CHECK(says(gap_size(states[0]).reason, "too small"));
    const auto gap = gap_size(states[3]);
    CHECK(gap.converged);
    CHECK(std::abs(gap.value - 2 * gap_in_radii(0.45)) < 5 * gap.error);
    const auto radius = fit_gap_radius(states);
    REQUIRE(radius.converged);
    CHECK(radius.degrees_of_freedom == 4);
    coverage.add(radius.parameter("slope").value, radius.parameter("slope").error, 2);
  }
  check(coverage);
}

TEST_CASE("gap size: errors and what is refused", "[statistics]") {
  const DissipationState state{0.5, 0.1, known(0.04, 0.004), known(3, 0.1)};  // bracket 3, l^2 = 4/3
  const auto gap = gap_size(state);
  CHECK(gap.value == Approx(std::sqrt(4.0 / 3)));
  // Derivatives by hand: dl/l = 0.5 (10 %) and 0.5 (0.2/3).
  CHECK(gap.error == Approx(gap.value * 0.5 * std::hypot(0.1, 0.2 / 3)));
  CHECK(says(gap_size({0, 0.1, known(1, 1), known(3, 1)}).reason, "volume fraction"));
  CHECK(says(gap_size({0.5, 0, known(1, 1), known(3, 1)}).reason, "not known"));
  CHECK(says(gap_size({0.5, 0.1, known(1, 0.1), known(1.6, 0.1)}).reason, "half"));
  auto young = state;
  young.relative_viscosity.converged = false;
  young.relative_viscosity.reason = "too short";
  CHECK(says(gap_size(young).reason, "viscosity: too short"));
  CHECK(says(fit_gap_radius({}).reason, "too few"));
  CHECK(gap_in_radii(1.0 / 8) == Approx(2));
}
