// Analysis: displacements, ballistic and diffusive, of cells that leave the bulk.
#include "physics/analysis/analyse.hpp"
#include "tests/catch.hpp"
#include "tests/unit/synthetic_run.hpp"

using namespace corpuscle;
using namespace corpuscle::test;
using analysis::CellQuantity;
using Eigen::Index;

TEST_CASE("analysis: the MSD counts cells that begin in the bulk", "[analysis]") {
  SyntheticRun run{.times = 400, .cells = 12, .deviation = {0.2, 0.1, 1}};
  const auto record = run.record();
  const auto found = analysis::analyse(record, {.wall_layer = 3, .discard = 0});
  const auto& msd = found.curve("msd_z");
  const Index point = 30, lag = std::lround(msd.x[point] / 0.1);
  REQUIRE(lag > 30);
  double sum = 0, count = 0, both = 0, both_count = 0;
  for (Index cell = 0; cell < 12; ++cell) {
    for (Index t = 0; t + lag < 400; ++t) {
      const double z = run.memory->at(CellQuantity::centre, t, cell, 2), later = run.memory->at(CellQuantity::centre, t + lag, cell, 2);
      if (z < 15 || z > 45) continue;
      sum += (later - z) * (later - z) / 25;
      count += 1;
      if (later < 15 || later > 45) continue;
      both += (later - z) * (later - z) / 25;
      both_count += 1;
    }
  }
  CHECK(msd.value[point] == Approx(sum / count));
  CHECK(both / both_count < 0.95 * sum / count);  // what asking for both ends would give
  CHECK(msd.value[0] == 0);
  CHECK(found.settings.longest_lag == Approx(0.1 * 100));
}

TEST_CASE("analysis: exponents of ballistic and diffusive motion", "[analysis]") {
  SyntheticRun run{.times = 6000, .cells = 20, .interval = 0.05, .decay = std::exp(-0.05)};  // correlations last one strain
  const auto found = analysis::analyse(run.record(), {.wall_layer = 1, .discard = 0});
  // MSD = 2 D (t - tau (1 - exp(-t/tau))) with tau = 1: exponents from the formula at the same lags.
  const auto& msd = found.curve("msd_y");
  const auto exponent = [&](double from, double to) {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (Index i = 1; i < msd.x.size(); ++i) {
      if (msd.x[i] < 0.999 * from || msd.x[i] > 1.001 * to) continue;
      const double u = std::log(msd.x[i]), v = std::log(msd.x[i] - 1 + std::exp(-msd.x[i]));
      n += 1, sx += u, sy += v, sxx += u * u, sxy += u * v;
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
  };
  CHECK(found.estimate("msd_exponent_y_early").value == Approx(exponent(0, 0.3)).margin(0.03));
  CHECK(exponent(0, 0.3) > 1.9);
  const auto& late = found.estimate("msd_exponent_y_late");
  const double last = 0.05 * 6000 / 8 / 2;
  CHECK(late.converged);
  agrees(late, exponent(last / 10, last));
  CHECK(found.curve("msd_exponent_y").trusted_until == Approx(last));
  agrees(found.estimate("diffusivity_msd_y"), run.diffusivity(1));
  const auto& line = found.fit("msd_y_line");
  agrees(line.fit.parameter("slope"), 2 * run.diffusivity(1));
  CHECK(line.fit.parameter("slope").value == Approx(2 * found.estimate("diffusivity_msd_y").value).epsilon(0.3));
  CHECK(line.to == Approx(last));
  CHECK(line.from == Approx(last / 2));
}

TEST_CASE("analysis: displacements over a window of 0.1 strains", "[analysis]") {
  SyntheticRun run{.times = 3000, .cells = 20, .interval = 0.05};
  const auto record = run.record();
  const auto found = analysis::analyse(record, {.wall_layer = 2, .discard = 0});
  const auto& curve = found.curve("displacement_acf_y");
  const Index lag = 4;
  double zero = 0, later = 0, zeros = 0, laters = 0;
  const auto y = [&](Index t, Index cell) { return run.memory->at(CellQuantity::centre, t, cell, 1); };
  for (Index cell = 0; cell < 20; ++cell) {
    for (Index t = 0; t + 2 < 3000; ++t) {
      const double z = run.memory->at(CellQuantity::centre, t, cell, 2);
      if (z < 10 || z > 50) continue;
      zero += std::pow(y(t + 2, cell) - y(t, cell), 2);
      zeros += 1;
      if (t + lag + 2 >= 3000) continue;
      later += (y(t + 2, cell) - y(t, cell)) * (y(t + lag + 2, cell) - y(t + lag, cell));
      laters += 1;
    }
  }
  REQUIRE(curve.x[lag] == Approx(0.2));
  CHECK(curve.value[lag] == Approx(later / laters / (zero / zeros)));
}
