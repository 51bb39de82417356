// The period of tumbling, against Jeffery's orbit and a swinging axis.
#include <cmath>
#include <numbers>

#include "physics/statistics/tumbling.hpp"
#include "tests/catch.hpp"

using namespace corpuscle::statistics;

namespace {

struct Axes {
  Eigen::MatrixXd x, y, z;
  explicit Axes(Eigen::Index times, Eigen::Index cells = 1) : x(times, cells), y(Eigen::MatrixXd::Zero(times, cells)), z(times, cells) {}
  void set(Eigen::Index t, Eigen::Index cell, double angle) {
    const double sign = t % 3 == 0 ? -1 : 1;  // an axis has no sign
    x(t, cell) = sign * std::sin(angle);
    z(t, cell) = sign * std::cos(angle);
  }
  Estimate period(double step) const { return tumbling_period({x, y, z}, step); }
};

}  // namespace

TEST_CASE("tumbling: Jeffery's period of a disc", "[statistics]") {
  // Axis of a spheroid of aspect ratio p in the shear plane: tan(angle) = p tan(t/(p + 1/p)) from the gradient direction on (Jeffery 1922).
  const double p = 0.33, rate = 1 / (p + 1 / p), period = 2 * std::numbers::pi * (p + 1 / p), step = 0.1;
  Axes axes(Eigen::Index(2.3 * period / step), 2);
  for (Eigen::Index t = 0; t < axes.x.rows(); ++t) {
    const double phase = rate * (double(t) * step + 1.7);
    axes.set(t, 0, std::atan2(p * std::sin(phase), std::cos(phase)));
    axes.set(t, 1, -std::atan2(p * std::sin(phase + 1), std::cos(phase + 1)));  // the other sense
  }
  const Estimate found = axes.period(step);
  CHECK(found.value == Approx(period).epsilon(1e-3));
  CHECK(found.effective_samples == 7);  // four passages of the first, five of the second
  CHECK(found.converged);
  CHECK(found.error < 1e-2);
}

TEST_CASE("tumbling: a cell that swings, one that stops, a gap", "[statistics]") {
  Axes axes(400);
  for (Eigen::Index t = 0; t < 400; ++t) axes.set(t, 0, 0.5 * std::sin(0.1 * double(t)));
  CHECK(std::isnan(axes.period(0.1).value));
  CHECK(axes.period(0.1).reason.find("none tumbles") != std::string::npos);
  for (Eigen::Index t = 0; t < 400; ++t) axes.set(t, 0, 0.1 + std::min(4.0, 0.1 * double(t)));  // one passage, at pi
  CHECK(std::isnan(axes.period(0.1).value));
  for (Eigen::Index t = 0; t < 400; ++t) axes.set(t, 0, 0.02 * double(t));  // 0, pi and 2 pi: two halves
  const Estimate two = axes.period(0.1);
  CHECK(two.value == Approx(0.1 * 2 * std::numbers::pi / 0.02).epsilon(1e-6));
  CHECK_FALSE(two.converged);
  axes.x(200, 0) = std::nan("");
  CHECK(std::isnan(axes.period(0.1).value));
}
