// Correlations and mean square displacements by FFT and by streaming, against direct sums and processes with known answers.
#include <cmath>
#include <string>
#include <vector>

#include "physics/statistics/correlation.hpp"
#include "physics/statistics/multiple_tau_correlator.hpp"
#include "tests/catch.hpp"
#include "tests/unit/synthetic_series.hpp"

using namespace corpuscle::statistics;
using namespace corpuscle::test;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Definition, origins being multiples of `every`.
template <class Term>
double direct(const MatrixXd& a, const MatrixXd& b, Index lag, Index every, const Term& term) {
  double sum = 0, count = 0;
  for (Index p = 0; p < a.cols(); ++p) {
    for (Index s = 0; s + lag < a.rows(); s += every) {
      const double x = term(a(s, p), b(s + lag, p));
      if (std::isnan(x)) continue;
      sum += x;
      count += 1;
    }
  }
  return sum / count;
}

double product(double x, double y) { return x * y; }
double squared_step(double x, double y) { return (y - x) * (y - x); }

/// Running sums of the columns: a walk whose steps are the entries.
MatrixXd walk(const MatrixXd& steps) {
  MatrixXd x = steps;
  for (Index i = 1; i < x.rows(); ++i) x.row(i) += x.row(i - 1);
  return x;
}

}  // namespace

TEST_CASE("correlation by FFT equals the direct sum, with and without gaps, in any layout", "[statistics]") {
  Normal normal(1);
  for (const bool gaps : {false, true}) {
    MatrixXd a = ar1_matrix(0.8, 101, 3, normal), b = ar1_matrix(0.5, 101, 3, normal);
    if (gaps) {
      for (Index i = 0; i < 30; ++i) a(static_cast<Index>(normal.uniform() * 100), static_cast<Index>(i % 2)) = not_a_number;
      b(7, 1) = b(8, 1) = not_a_number;
    }
    for (const Blocks blocks_of : {Blocks::times, Blocks::particles}) {
      const CorrelationOptions options{.longest_lag = 60, .removal = MeanRemoval::none, .blocks_of = blocks_of, .blocks = 7};
      const auto cross = cross_correlation(a, b, 0.5, options), itself = autocorrelation(a, 0.5, options), msd = mean_square_displacement(a, 0.5, options);
      REQUIRE(cross.points() == 61);
      CHECK(cross.blocks() == (blocks_of == Blocks::times ? 7 : 3));
      for (const Index lag : {0, 1, 2, 13, 59, 60}) {
        CAPTURE(gaps, lag);
        CHECK(cross.x[lag] == Approx(0.5 * static_cast<double>(lag)));
        CHECK(cross.value()[lag] == Approx(direct(a, b, lag, 1, product)).margin(1e-13));
        CHECK(itself.value()[lag] == Approx(direct(a, a, lag, 1, product)).margin(1e-13));
        CHECK(msd.value()[lag] == Approx(direct(a, a, lag, 1, squared_step)).margin(1e-13));
      }
    }
  }
  // One component of an array [times][particles][3].
  std::vector<double> array(50 * 4 * 3);
  for (double& x : array) x = normal();
  const SeriesMatrix y = Eigen::Map<const MatrixXd, 0, SeriesStride>(array.data() + 1, 50, 4, SeriesStride(3, 12));
  CHECK(y(1, 2) == array[12 + 6 + 1]);
  CHECK(autocorrelation(y, 1).value()[3] == Approx(direct(y, y, 3, 1, product)));
}

TEST_CASE("correlation: blocks add up to sums over their own origins", "[statistics]") {
  Normal normal(2);
  const MatrixXd x = ar1_matrix(0.6, 40, 2, normal);
  const auto curve = autocorrelation(x, 1, {.longest_lag = 15, .removal = MeanRemoval::none, .blocks_of = Blocks::times, .blocks = 4});
  for (Index b = 0; b < 4; ++b) {
    double sum = 0, count = 0;
    for (Index p = 0; p < 2; ++p) {
      for (Index s = 10 * b; s < 10 * b + 10 && s + 15 < 40; ++s, ++count) sum += x(s, p) * x(s + 15, p);
    }
    CHECK(curve.counts(15, b) == count);
    CHECK(curve.sums(15, b) == Approx(sum).margin(1e-13));
  }
  CHECK(curve.block_length == 10);
  CHECK(says(with_errors(curve).reason, "too few"));
}

TEST_CASE("correlation: removal of means", "[statistics]") {
  MatrixXd x(8, 2);
  x.col(0).setConstant(3);
  x.col(1).setConstant(5);
  CHECK(autocorrelation(x, 1).value()[1] == Approx(17));
  CHECK(autocorrelation(x, 1, {.longest_lag = 0, .removal = MeanRemoval::overall, .blocks_of = Blocks::times, .blocks = 2}).value()[1] == Approx(1));
  const auto none = autocorrelation(x, 1, {.longest_lag = 0, .removal = MeanRemoval::particle, .blocks_of = Blocks::times, .blocks = 2});
  CHECK(none.value()[1] == Approx(0).margin(1e-15));
  CHECK(says(normalised(none).reason, "constant"));
}

TEST_CASE("correlation: an Ornstein-Uhlenbeck process with error bars that cover it", "[statistics]") {
  Normal normal(3);
  const double a = std::exp(-0.2);
  Coverage value, ratio, displacement, by_particles;
  for (int i = 0; i < 200; ++i) {
    const MatrixXd v = ar1_matrix(a, 1500, 3, normal);
    const CorrelationOptions options{.longest_lag = 40, .removal = MeanRemoval::none, .blocks_of = Blocks::times, .blocks = 16};
    const auto blocked = autocorrelation(v, 0.2, options);
    const Resampling resampling{100, static_cast<std::uint64_t>(i)};
    const Curve curve = with_errors(blocked, {}, resampling), shape = normalised(blocked, resampling);
    CHECK(curve.converged);
    value.add(curve.value[5], curve.error[5], std::exp(-1.0));
    ratio.add(shape.value[10], shape.error[10], std::exp(-2.0));
    // Discrete velocity sums: MSD(n) = n (1+a)/(1-a) - 2 a (1 - a^n)/(1-a)^2.
    const Curve msd = with_errors(mean_square_displacement(walk(v), 0.2, options), {}, resampling);
    displacement.add(msd.value[30], msd.error[30], 30 * (1 + a) / (1 - a) - 2 * a * (1 - std::pow(a, 30)) / std::pow(1 - a, 2));
    const MatrixXd many = ar1_matrix(a, 60, 40, normal);
    const Curve group = with_errors(autocorrelation(many, 0.2, {.longest_lag = 20, .removal = MeanRemoval::none, .blocks_of = Blocks::particles, .blocks = 20}),
                                    {}, resampling);
    by_particles.add(group.value[5], group.error[5], std::exp(-1.0));
  }
  for (const auto& coverage : {value, ratio, displacement, by_particles}) {
    CAPTURE(coverage.share(), coverage.error());
    CHECK(coverage.share() > 0.60);
    CHECK(coverage.share() < 0.75);
  }
}

TEST_CASE("mean square displacement: ballistic and diffusive walkers and their local exponents", "[statistics]") {
  Normal normal(4);
  const Index times = 800, particles = 60;
  MatrixXd ballistic(times, particles);
  for (Index p = 0; p < particles; ++p) ballistic.col(p) = VectorXd::LinSpaced(times, 1e3, 1e3 + normal() * static_cast<double>(times - 1));
  const auto straight = mean_square_displacement(ballistic, 0.1);
  const auto slope = local_exponent(straight);
  for (const Index i : {3, 20, 150}) {
    CHECK(slope.value[i] == Approx(2).epsilon(1e-6));
    CHECK(straight.value()[i] == Approx(straight.value()[1] * static_cast<double>(i * i)).epsilon(1e-6));  // rounding: 1e-15 (400)^2
  }
  CHECK(std::isnan(slope.value[0]));

  const MatrixXd random = walk(ar1_matrix(0, times, particles, normal));
  const auto diffusive = mean_square_displacement(random, 0.1);
  const auto exponent = local_exponent(diffusive);
  const Curve curve = with_errors(diffusive);
  for (const Index i : {3, 10, 50}) {
    CAPTURE(i, curve.error[i], exponent.error[i]);
    CHECK(std::abs(curve.value[i] - static_cast<double>(i)) < 4 * curve.error[i]);
    CHECK(std::abs(exponent.value[i] - 1) < 4 * exponent.error[i]);
    CHECK(exponent.error[i] < 0.1);
  }
  const auto few = thinned(diffusive, 6);
  CHECK(few.points() < 50);
  CHECK(few.x[few.points() - 1] == diffusive.x[diffusive.points() - 1]);
  CHECK(few.value()[3] == diffusive.value()[3]);
}

TEST_CASE("correlation: what cannot be computed is said", "[statistics]") {
  CHECK(says(autocorrelation(MatrixXd(100, 0), 1).reason, "no particle"));
  CHECK(says(autocorrelation(MatrixXd::Ones(3, 2), 1).reason, "too few"));
  CHECK(says(autocorrelation(MatrixXd::Constant(30, 2, not_a_number), 1).reason, "no valid sample"));
  CHECK(says(cross_correlation(MatrixXd::Ones(30, 2), MatrixXd::Ones(30, 3), 1).reason, "shapes"));
  CHECK(says(with_errors(autocorrelation(MatrixXd::Ones(3, 2), 1)).reason, "too few"));
  CHECK(says(with_errors(autocorrelation(MatrixXd::Random(64, 2), 1, {.longest_lag = 20, .removal = {}, .blocks_of = {}, .blocks = 16})).reason, "block"));
  CHECK(autocorrelation(MatrixXd::Ones(50, 1), 1).value()[5] == Approx(1));  // one particle is enough
  CHECK(mean_square_displacement(MatrixXd::Constant(50, 1, 1e6), 1).value().cwiseAbs().maxCoeff() == 0);
  CHECK(local_exponent(VectorXd::LinSpaced(5, 0, 4), VectorXd::Zero(5)).array().isNaN().all());
}

TEST_CASE("multiple-tau correlator equals the direct sum over every 2^k-th origin", "[statistics]") {
  Normal normal(5);
  using Quantity = MultipleTauCorrelator::Quantity;
  MatrixXd x = ar1_matrix(0.9, 1000, 3, normal);
  x(100, 1) = x(101, 1) = x(500, 2) = not_a_number;
  MultipleTauCorrelator product_of(Quantity::autocorrelation, 3, 0.5, {.channels = 8, .levels = 12, .average = false, .blocks = 8});
  MultipleTauCorrelator steps_of(Quantity::mean_square_displacement, 3, 0.5, {.channels = 8, .levels = 12, .average = false, .blocks = 8});
  for (Index i = 0; i < x.rows(); ++i) {
    const VectorXd row = x.row(i);
    product_of.add({row.data(), 3});
    steps_of.add({row.data(), 3});
  }
  const auto correlation = product_of.result(), msd = steps_of.result();
  CHECK(correlation.x[correlation.points() - 1] == 0.5 * 7 * 128);  // 1000 samples leave 8 to the level of 128
  CHECK(correlation.blocks() > 8);
  CHECK(correlation.blocks() <= 16);
  for (Index i = 0; i < correlation.points(); ++i) {
    const auto lag = static_cast<Index>(correlation.x[i] / 0.5);
    Index every = 1;
    while (lag / every >= 8) every *= 2;
    CAPTURE(lag, every);
    CHECK(correlation.value()[i] == Approx(direct(x, x, lag, every, product)).margin(1e-13));
    CHECK(msd.value()[i] == Approx(direct(x, x, lag, every, squared_step)).margin(1e-13));
  }
}

TEST_CASE("multiple-tau correlator: averaging, errors and memory", "[statistics]") {
  Normal normal(6);
  using Quantity = MultipleTauCorrelator::Quantity;
  const Index times = 40000;
  const double a = std::exp(-0.05);
  const MatrixXd x = ar1_matrix(a, times, 1, normal);
  MultipleTauCorrelator correlator(Quantity::autocorrelation, 1, 0.05, {.channels = 16, .levels = 6, .average = true, .blocks = 16});
  MatrixXd means(times / 4, 1);
  std::size_t bytes = 0;
  for (Index i = 0; i < times; ++i) {
    correlator.add({&x(i, 0), 1});
    if (i == times / 8) bytes = correlator.bytes();
  }
  CHECK(correlator.bytes() == bytes);  // all six levels were there after an eighth
  CHECK(correlator.samples() == times);
  for (Index i = 0; i < means.rows(); ++i) means(i, 0) = x.col(0).segment(4 * i, 4).mean();
  const auto curve = correlator.result();
  const Curve with = with_errors(curve);
  CHECK(with.converged);
  for (Index i = 0; i < curve.points(); ++i) {
    CAPTURE(curve.x[i], with.value[i], with.error[i]);
    if (curve.x[i] >= 1.6 && curve.x[i] < 3.1) CHECK(curve.value()[i] == Approx(direct(means, means, std::lround(curve.x[i] / 0.2), 1, product)).margin(1e-13));
    // The mean of 2^k samples raises C by less than (2^k dt/T)^2/12 of itself.
    const double width = curve.x[i] / 8;
    CHECK(std::abs(with.value[i] - std::exp(-curve.x[i])) < 4 * with.error[i] + width * width / 12 * std::exp(-curve.x[i]));
  }
  for (const bool average : {false, true}) {  // one that was saved in the middle, where levels are half full, and went on
    const MultipleTauOptions options{.channels = 8, .levels = 5, .average = average, .blocks = 4};
    MultipleTauCorrelator whole(Quantity::autocorrelation, 1, 0.05, options), first(Quantity::autocorrelation, 1, 0.05, options), second = first;
    for (Index i = 0; i < 1000; ++i) whole.add({&x(i, 0), 1});
    for (Index i = 0; i < 531; ++i) first.add({&x(i, 0), 1});
    auto saved = first.save();
    REQUIRE(second.restore(saved));
    for (Index i = 531; i < 1000; ++i) second.add({&x(i, 0), 1});
    CHECK((second.result().sums.array() == whole.result().sums.array()).all());
    CHECK((second.result().counts.array() == whole.result().counts.array()).all());
    MultipleTauCorrelator other(Quantity::autocorrelation, 2, 0.05, options);
    CHECK(!other.restore(saved));
    saved.pop_back();
    CHECK(!second.restore(saved));
    saved = {-1, 1};
    CHECK(!second.restore(saved));
    CHECK(second.samples() == 1000);
  }
  MultipleTauCorrelator empty(Quantity::autocorrelation, 0, 1);
  CHECK(says(empty.result().reason, "no particle"));
  MultipleTauCorrelator young(Quantity::autocorrelation, 2, 1);
  CHECK(says(young.result().reason, "too few"));
  const std::vector<double> missing(2, not_a_number);
  for (int i = 0; i < 5; ++i) young.add(missing);
  CHECK(says(young.result().reason, "no valid sample"));
}

TEST_CASE("correlation: MSD over chosen origins", "[statistics]") {
  Normal normal(5);
  const MatrixXd x = ar1_matrix(0.8, 60, 3, normal);
  MatrixXd origins = MatrixXd::Ones(60, 3);
  for (Index t = 0; t < 60; t += 3) origins(t, t % 2) = not_a_number;
  MatrixXd gaps = x;
  gaps(17, 2) = gaps(40, 1) = not_a_number;
  const auto msd = mean_square_displacement(gaps, origins, 0.5, {.longest_lag = 10, .blocks = 4});
  for (Index lag = 1; lag <= 10; ++lag) {
    double sum = 0, count = 0;
    for (Index p = 0; p < 3; ++p) {
      for (Index t = 0; t + lag < 60; ++t) {
        const double square = std::pow(gaps(t + lag, p) - gaps(t, p), 2);
        if (std::isnan(square) || std::isnan(origins(t, p))) continue;
        sum += square;
        count += 1;
      }
    }
    CHECK(msd.counts.row(lag).sum() == count);
    CHECK(msd.value()[lag] == Approx(sum / count));
  }
  CHECK(says(mean_square_displacement(x, origins.topRows(5), 0.5, {}).reason, "shapes"));
}
