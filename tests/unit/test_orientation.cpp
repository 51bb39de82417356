// Orientation tensors, mean inclinations and motions of axes that are known.
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>

#include "physics/statistics/orientation.hpp"
#include "tests/catch.hpp"
#include "tests/unit/synthetic_series.hpp"

using namespace corpuscle::statistics;
using namespace corpuscle::test;
using Eigen::Index;
using Eigen::MatrixXd;

namespace {

constexpr double pi = std::numbers::pi;

struct Axes {
  MatrixXd x, y, z;
  Axes(Index times, Index cells) : x(MatrixXd::Zero(times, cells)), y(x), z(x) {}
  void set(Index t, Index cell, const Eigen::Vector3d& n) {
    x(t, cell) = n.x();
    y(t, cell) = n.y();
    z(t, cell) = n.z();
  }
  AxisSeries series() const { return {x, y, z}; }
};

Eigen::Vector3d in_plane(double angle) { return {std::cos(angle), 0, std::sin(angle)}; }

}  // namespace

TEST_CASE("orientation: aligned, planar, isotropic and conical axes", "[statistics]") {
  Normal normal(1);
  const Index times = 400, cells = 20;
  Axes aligned(times, cells), planar(times, cells), isotropic(times, cells), cone(times, cells);
  const double open = 0.4;
  for (Index t = 0; t < times; ++t) {
    for (Index c = 0; c < cells; ++c) {
      const double sign = normal.uniform() < 0.5 ? -1 : 1;  // has no meaning
      aligned.set(t, c, sign * in_plane(0.3));
      planar.set(t, c, in_plane(2 * pi * normal.uniform()));
      isotropic.set(t, c, Eigen::Vector3d(normal(), normal(), normal()).normalized());
      const double azimuth = 2 * pi * normal.uniform();
      cone.set(t, c, sign * Eigen::Vector3d(std::sin(open) * std::cos(azimuth), std::sin(open) * std::sin(azimuth), std::cos(open)));
    }
  }
  const auto one = orientation(aligned.series());
  CHECK(one.order.value == Approx(1));
  CHECK(one.order.error < 1e-12);
  CHECK(std::abs(one.director.dot(in_plane(0.3))) == Approx(1));
  const auto plane = orientation(planar.series());
  CHECK(std::abs(plane.tensor(0, 0) - 0.5) < 4 * plane.tensor_error(0, 0));
  CHECK(plane.tensor(1, 1) == 0);
  CHECK(plane.order.value == Approx(0.25).margin(0.03));
  const auto none = orientation(isotropic.series());
  for (int a = 0; a < 3; ++a) CHECK(std::abs(none.tensor(a, a) - 1.0 / 3) < 4 * none.tensor_error(a, a));
  CHECK(none.tensor.trace() == Approx(1));
  CHECK(none.order.value < 3 / std::sqrt(8000.0));
  const auto tilted = orientation(cone.series());
  CHECK(std::abs(tilted.order.value - (1.5 * std::pow(std::cos(open), 2) - 0.5)) < 1e-4 + 4 * tilted.order.error);
  CHECK(std::abs(tilted.director.z()) == Approx(1).epsilon(1e-3));

  CHECK(says(orientation(Axes(20, 0).series()).order.reason, "no valid"));
  CHECK(says(orientation(Axes(3, 2).series()).order.reason, "too few"));
}

TEST_CASE("axial mean: angles near the seam, coverage, and no preferred direction", "[statistics]") {
  Normal normal(2);
  Coverage coverage;
  for (int i = 0; i < 300; ++i) {
    MatrixXd angles = 0.3 * ar1_matrix(0.6, 800, 2, normal);
    for (Index k = 0; k < angles.size(); ++k) {
      double& angle = angles.data()[k];
      angle += 1.5;
      if (angle > pi / 2) angle -= pi;
    }
    const auto mean = axial_mean(angles, 16, {100, static_cast<std::uint64_t>(i)});
    double difference = mean.angle.value - 1.5;
    difference -= pi * std::round(difference / pi);
    coverage.add(difference, mean.angle.error, 0);
    CHECK(mean.resultant.value == Approx(std::exp(-2 * 0.09)).margin(5 * mean.resultant.error));  // Gaussian: exp(-2 sigma^2)
  }
  CAPTURE(coverage.share(), coverage.error());
  CHECK(coverage.share() > 0.60);
  CHECK(coverage.share() < 0.75);
  const MatrixXd anything = pi * (MatrixXd::Random(2000, 3).array() / 2);
  CHECK(says(axial_mean(anything).angle.reason, "no preferred"));
  CHECK(says(axial_mean(MatrixXd::Constant(10, 2, not_a_number)).angle.reason, "no valid"));
}

TEST_CASE("motion shares: tumbling by Jeffery's orbit, swinging and rolling cells", "[statistics]") {
  // tan(phi) = tan(shear p t/(p^2 + 1))/p: turns by pi in half a period, pi (p + 1/p) strains.
  const double p = 1 / 0.3235, step = 0.2, half_period = pi * (p + 1 / p);
  const Index times = 1001, cells = 12;
  Axes axes(times, cells);
  Normal normal(3);
  for (Index c = 0; c < cells; ++c) {
    const double phase = 2 * pi * normal.uniform();
    for (Index t = 0; t < times; ++t) {
      const double strain = step * static_cast<double>(t), turn = pi * strain / half_period + phase;
      const double sign = normal.uniform() < 0.5 ? -1 : 1;
      if (c < 6) {
        axes.set(t, c, sign * in_plane(-std::atan2(std::sin(turn) / p, std::cos(turn))));
      } else if (c < 9) {
        axes.set(t, c, sign * in_plane(0.3 + 0.5 * std::sin(turn)));
      } else {
        axes.set(t, c, sign * (Eigen::Vector3d(0, 1, 0) + 0.1 * in_plane(7 * turn)).normalized());
      }
    }
  }
  for (const double window : {0.0, 20.0}) {
    const auto shares = motion_shares(axes.series(), step, window);
    CAPTURE(window);
    CHECK(shares.tumbling.converged);
    CHECK(shares.tumbling.value == Approx(0.5));
    CHECK(shares.steady.value == Approx(0.25));
    CHECK(shares.rolling.value == Approx(0.25));
    // Whole windows of 20 strains and orbits of 10.7: a window sees 1.87 half turns on average, whatever its phase.
    CHECK(shares.half_turns.value == Approx(1 / half_period).epsilon(window > 0 ? 0.02 : 0.03));
  }
  CHECK(motion_shares(axes.series(), step, 5).tumbling.value < 0.5);  // half a turn doesn't fit into 5 strains at every phase

  MatrixXd x = axes.x, z = axes.z, y = axes.y;
  for (Index t = 100; t < 160; ++t) x(t, 0) = not_a_number;
  CHECK(motion_shares({x, y, z}, step, 0).tumbling.value == Approx(0.5));
  // Every 25th sample: half an orbit between two.
  const Index few = 41;
  const MatrixXd rare_x = Eigen::Map<const MatrixXd, 0, SeriesStride>(axes.x.data(), few, 6, SeriesStride(times, 25));
  const MatrixXd rare_y = MatrixXd::Zero(few, 6), rare_z = Eigen::Map<const MatrixXd, 0, SeriesStride>(axes.z.data(), few, 6, SeriesStride(times, 25));
  const auto rare = motion_shares({rare_x, rare_y, rare_z}, 25 * step, 0);
  CHECK_FALSE(rare.tumbling.converged);

  CHECK(says(motion_shares(Axes(10, 0).series(), 1).tumbling.reason, "no cell"));
  CHECK(says(motion_shares(Axes(10, 2).series(), 1, 20).steady.reason, "doesn't fit"));
  CHECK(says(motion_shares(Axes(10, 1).series(), 1).tumbling.reason, "too few"));
  CHECK(says(motion_shares(Axes(10, 9).series(), 1).half_turns.reason, "no cell tumbles"));
}
