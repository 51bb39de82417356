// Profiles across the gap and fluctuations about them, for cells whose mean flow is given.
#include <cmath>
#include <string>

#include "physics/statistics/histogram.hpp"
#include "physics/statistics/profile.hpp"
#include "tests/catch.hpp"
#include "tests/unit/synthetic_series.hpp"

using namespace corpuscle::statistics;
using namespace corpuscle::test;
using Eigen::Index;
using Eigen::MatrixXd;

TEST_CASE("profile: mean flow, density and fluctuations of cells in a channel", "[statistics]") {
  Normal normal(1);
  const Index times = 800, cells = 100;
  MatrixXd z(times, cells), noise = 0.1 * ar1_matrix(0.5, times, cells, normal);
  for (Index k = 0; k < z.size(); ++k) z.data()[k] = 10 * normal.uniform();
  const MatrixXd u = (z.array() - 0.05 * z.array().square()).matrix() + noise;  // half a Poiseuille flow
  const ProfileOptions options{.low = 0, .high = 10, .bins = 20, .blocks = 16};
  const Curve flow = with_errors(profile(z, u, options));
  CHECK(flow.converged);
  double chi2 = 0;
  for (Index i = 0; i < 20; ++i) {
    const double at = flow.x[i];
    CHECK(at == Approx(0.25 + 0.5 * static_cast<double>(i)));
    const double truth = at - 0.05 * (at * at + 0.25 / 12);  // mean over the bin
    chi2 += std::pow((flow.value[i] - truth) / flow.error[i], 2);
  }
  CHECK(chi2 < 60);  // 20 degrees, Student's t of 16 blocks: more than 60 has a probability of 1e-3

  // 100 cells of volume 0.5 in 10 x area 4.
  const Curve fraction = with_errors(density_profile(z, MatrixXd::Constant(times, cells, 0.5), 4, options));
  for (Index i = 0; i < 20; ++i) CHECK(std::abs(fraction.value[i] - 1.25) < 4.5 * fraction.error[i]);
  CHECK(fraction.value.mean() == Approx(1.25));

  // The measured profile gives the noise back: linear interpolation errs by u''h^2/8 = 0.003, the profile by its error.
  const auto about_measured = moments(fluctuations(z, u, flow)), about_linear = moments(fluctuations(z, u, 0.5, 0));
  CHECK(about_measured.variance.value == Approx(0.01).epsilon(0.03));
  CHECK(about_linear.variance.value == Approx(0.01 + 25.0 / 180).epsilon(0.03));  // 0.05 z (10 - z) is left of the flow
  CHECK(moments(fluctuations(z, (2 * (z.array() - 5)).matrix() + noise, 2, 5)).variance.value == Approx(0.01).epsilon(0.03));
}

TEST_CASE("profile: bulk, gaps and what is refused", "[statistics]") {
  MatrixXd z(3, 2), u(3, 2);
  z << 1, 5, 2, not_a_number, 9, 5;
  u << 1, 2, 3, 4, not_a_number, 6;
  const ProfileOptions options{.low = 0, .high = 10, .bins = 2, .blocks = 1};
  const auto curve = profile(z, u, options);
  CHECK(curve.value() == Eigen::Vector2d(2, 4));
  CHECK(says(with_errors(curve).reason, "too few"));
  const MatrixXd bulk = within(z, 2, 8);
  CHECK(std::isnan(bulk(0, 0)));
  CHECK(bulk(0, 1) == 1);
  CHECK(bulk(1, 0) == 1);
  CHECK(std::isnan(bulk(1, 1)));
  CHECK(std::isnan(bulk(2, 0)));
  CHECK(says(profile(z, u.topRows(2), options).reason, "shapes"));
  CHECK(says(profile(z, u, {.low = 1, .high = 1}).reason, "no profile"));
  CHECK(says(profile(z, u, {.low = 20, .high = 30}).reason, "no cell"));
  CHECK(says(profile(MatrixXd(0, 0), MatrixXd(0, 0), options).reason, "no sample"));
  CHECK(says(density_profile(z, u, 0, options).reason, "area"));
  CHECK(fluctuations(z, u, Curve{}).array().isNaN().all());
  const auto about = fluctuations(z, u, with_errors(curve));  // 2 at 2.5, 4 at 7.5: extrapolated to 1 and 9
  CHECK(about(0, 0) == Approx(1 - 1.4));
  CHECK(about(0, 1) == Approx(2 - 3));
  CHECK(std::isnan(about(2, 0)));
  CHECK(std::isnan(about(1, 1)));
}
