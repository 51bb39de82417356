// Analysis: stress of single cells.
#include "physics/analysis/analyse.hpp"
#include "tests/catch.hpp"
#include "tests/unit/synthetic_run.hpp"

using namespace corpuscle;
using namespace corpuscle::test;
using analysis::CellQuantity;
using Eigen::Index;

TEST_CASE("analysis: fluctuation and relaxation of single stresslets", "[analysis]") {
  SyntheticRun run{.times = 5000, .cells = 25};
  const auto found = analysis::analyse(run.record(), {.wall_layer = 2, .discard = 0});
  agrees(found.estimate("stress_fluctuation"), 0.3);
  CHECK(found.estimate("stress_fluctuation").converged);
  CHECK(found.estimate("stress_fluctuation").error < 0.05 * 0.3);
  agrees(found.estimate("stresslet_relaxation_time"), run.relaxation_time() * (1 - std::exp(-6.0)));
  const auto& correlation = found.curve("stresslet_autocorrelation");
  CHECK(correlation.value[0] == Approx(1));
  CHECK(std::abs(correlation.value[5] - std::exp(-1)) < 5 * correlation.error[5]);
  const auto& density = found.curve("pdf_stresslet");
  CHECK(density.value.sum() * (density.x[1] - density.x[0]) == Approx(1).epsilon(1e-3));
  CHECK(density.value.dot(density.x) * (density.x[1] - density.x[0]) == Approx(1).epsilon(0.01));  // over the mean
  const auto& profile = found.curve("profile_stress_xz");
  REQUIRE(profile.x.size() == 24);
  CHECK(profile.x[0] == Approx(0.25));
}

TEST_CASE("analysis: the stress profile adds up to the stress of the box", "[analysis]") {
  SyntheticRun run{.times = 200, .cells = 10};
  run.deviation[2] = 0;  // nobody leaves the box
  const auto found = analysis::analyse(run.record(), {.wall_layer = 0, .discard = 0});
  CHECK(1 + found.curve("profile_stress_xz").value.mean() == Approx(found.estimate("relative_viscosity").value));
}

TEST_CASE("analysis: stresslets without a mean have no relative fluctuation", "[analysis]") {
  SyntheticRun run{.times = 400, .cells = 4};
  const auto record = run.record();
  for (Index t = 0; t < run.times; ++t)
    for (Index cell = 0; cell < 4; ++cell) run.memory->at(CellQuantity::stresslet, t, cell, 2) *= cell % 2 == 0 ? 1 : -1;
  const auto found = analysis::analyse(record, {.wall_layer = 0, .discard = 0});
  CHECK_FALSE(found.estimate("stress_fluctuation").converged);
  CHECK(says(found.estimate("stress_fluctuation").reason, "differ from zero"));
}
