// Analysis: prescribed ellipsoids, at rest and tumbling.
#include <numbers>

#include "physics/analysis/analyse.hpp"
#include "tests/catch.hpp"
#include "tests/unit/synthetic_run.hpp"

using namespace corpuscle;
using namespace corpuscle::test;
using Eigen::Index;

namespace {

constexpr analysis::AnalysisOptions everywhere{.wall_layer = 0, .discard = 0};

}  // namespace

TEST_CASE("analysis: deformation, inclination and order of equal cells", "[analysis]") {
  SyntheticRun run{.times = 800, .cells = 6};
  run.deviation[2] = 0;
  const auto found = analysis::analyse(run.record(), everywhere);
  CHECK(found.estimate("deformation").value == Approx(0.5));
  CHECK(found.estimate("inclination").value == Approx(0.3));
  CHECK(found.estimate("order_parameter").value == Approx(1));
  const auto& tensor = found.tensors.at(0);
  CHECK(tensor.name == "orientation");
  CHECK(tensor.value(0, 0) == Approx(std::pow(std::sin(0.3), 2)));
  CHECK(tensor.value(2, 2) == Approx(std::pow(std::cos(0.3), 2)));
  CHECK(tensor.value(0, 2) == Approx(-std::sin(0.3) * std::cos(0.3)));
  CHECK(tensor.value(1, 1) == Approx(0).margin(1e-12));
  CHECK(tensor.converged);
  CHECK(found.estimate("steady_share").value == 1);
  CHECK(found.estimate("tumbling_share").value == 0);
  CHECK(says(found.estimate("half_turns").reason, "no cell tumbles"));
  const auto& profile = found.curve("profile_deformation");
  for (Index i = 0; i < profile.x.size(); ++i) CHECK((std::isnan(profile.value[i]) || std::abs(profile.value[i] - 0.5) < 1e-9));
}

TEST_CASE("analysis: tumbling cells, and those that leave the bulk", "[analysis]") {
  SyntheticRun run{.times = 1600, .cells = 8};
  run.deviation[2] = 0;
  auto record = run.record();
  // The first two turn 0.5 rad a strain: 5.5 in a window of 11, more than pi. Half a turn every 2 pi strains.
  for (Index t = 0; t < run.times; ++t)
    for (Index cell = 0; cell < 2; ++cell) run.set_ellipsoid(t, cell, -0.05 * static_cast<double>(t));
  auto found = analysis::analyse(record, everywhere);
  CHECK(found.estimate("tumbling_share").value == Approx(0.25));
  CHECK(found.estimate("tumbling_share").converged);
  CHECK(found.estimate("steady_share").value == Approx(0.75));
  CHECK(found.estimate("rolling_share").value == 0);
  CHECK(found.estimate("half_turns").value == Approx(0.5 / std::numbers::pi));
  CHECK(found.estimate("tumbling_period").value == Approx(4 * std::numbers::pi));

  // One tumbler is put outside for some time in every window of 11 strains: none of its windows counts.
  for (Index t = 0; t < run.times; ++t)
    for (Index cell = 0; cell < 8; ++cell) run.memory->at(analysis::CellQuantity::centre, t, cell, 2) = cell == 0 && t % 50 < 5 ? 2 : 30;
  found = analysis::analyse(record, {.wall_layer = 1, .discard = 0});
  CHECK(found.estimate("tumbling_share").value == Approx(1.0 / 7));

  SyntheticRun brief{.times = 60, .cells = 8};
  brief.deviation[2] = 0;
  found = analysis::analyse(brief.record(), everywhere);
  CHECK(found.estimate("steady_share").value == 1);
  CHECK(says(found.estimate("steady_share").reason, "shorter than the 11 strains"));
}
