// Analysis: where the steady part begins, and what the user may ask for.
#include "physics/analysis/analyse.hpp"
#include "tests/catch.hpp"
#include "tests/complaint.hpp"
#include "tests/unit/synthetic_run.hpp"

using namespace corpuscle;
using namespace corpuscle::test;
using analysis::CellQuantity;
using Eigen::Index;

TEST_CASE("analysis: the start-up is that of the slowest series", "[analysis]") {
  SyntheticRun run{.times = 2000, .cells = 12};
  auto record = run.record();
  auto found = analysis::analyse(record, {.wall_layer = 1});
  CHECK(found.start_up.converged);
  const double quick = found.start_up_strain;
  Normal normal(2);
  for (auto& d : record.mean_deformation) d = 0.5 + 0.01 * normal();
  for (std::size_t i = 0; i < 600; ++i) record.mean_deformation[i] += 0.4;
  found = analysis::analyse(record, {.wall_layer = 1});
  CHECK(found.start_up_strain >= std::max(60.0, quick));
  CHECK(found.start_up_strain < 80);
  CHECK(found.settings.discarded_strain == found.start_up_strain);
  CHECK(found.estimate("relative_viscosity").converged);

  // The velocity variance and the stress are looked at as well.
  for (auto& d : record.mean_deformation) d = 0.5;
  for (Index t = 0; t < 700; ++t)
    for (Index cell = 0; cell < 12; ++cell) run.memory->at(CellQuantity::velocity, t, cell, 1) *= 4;
  CHECK(analysis::analyse(record, {.wall_layer = 1}).start_up_strain >= 70);
  for (Index t = 0; t < 800; ++t)
    for (Index cell = 0; cell < 12; ++cell) run.memory->at(CellQuantity::stresslet, t, cell, 2) *= 4;
  CHECK(analysis::analyse(record, {.wall_layer = 1}).start_up_strain >= 80);
}

TEST_CASE("analysis: a start-up that doesn't end takes the trust from all averages", "[analysis]") {
  SyntheticRun run{.times = 1000, .cells = 12};
  auto record = run.record();
  for (std::size_t i = 0; i < 1000; ++i) record.mean_deformation[i] = 0.5 + 0.001 * static_cast<double>(i);
  const auto found = analysis::analyse(record, {.wall_layer = 1});
  CHECK_FALSE(found.start_up.converged);
  CHECK(says(found.start_up.reason, "deformation"));
  for (const char* name : {"relative_viscosity", "velocity_variance_z", "deformation", "phi_bulk"}) {
    CAPTURE(name);
    CHECK(std::isfinite(found.estimate(name).value));
    CHECK_FALSE(found.estimate(name).converged);
    CHECK(says(found.estimate(name).reason, "start-up"));
  }
  CHECK(found.estimate("volume_drift_max").converged);
  REQUIRE_FALSE(found.warnings.empty());
  // Who knows better says so.
  CHECK(analysis::analyse(record, {.wall_layer = 1, .discard = 20}).estimate("relative_viscosity").converged);
}

TEST_CASE("analysis: --discard, --longest-lag and --wall-layer", "[analysis]") {
  SyntheticRun run{.times = 400, .cells = 12};
  auto record = run.record();
  auto found = analysis::analyse(record, {.wall_layer = 1, .discard = 10.01});
  CHECK(found.settings.discarded_strain == Approx(10.1));  // the first sample that isn't before
  CHECK(found.settings.longest_lag == Approx(0.1 * 74));
  found = analysis::analyse(record, {.wall_layer = 1, .discard = 10, .longest_lag = 2});
  CHECK(found.settings.longest_lag == Approx(2));
  CHECK(found.curve("msd_y").x.maxCoeff() == Approx(2));
  const auto complaint = [&](const analysis::AnalysisOptions& options, std::initializer_list<const char*> words) {
    return complaint_lacks([&] { analysis::analyse(record, options); }, words);
  };
  CHECK(complaint({.discard = 40}, {"--discard 40", "39.9 strains"}) == "");
  CHECK(complaint({.discard = -1}, {"--discard -1"}) == "");
  CHECK(complaint({.longest_lag = 0}, {"--longest-lag 0", "above 0"}) == "");
  CHECK(complaint({.discard = 30, .longest_lag = 20}, {"--longest-lag 20", "9.9 strains"}) == "");
  CHECK(complaint({.wall_layer = -2}, {"--wall-layer -2"}) == "");
  record.flow = analysis::FlowOf::rest;
  record.shear_rate = 0;
  record.interval = statistics::not_a_number;
  CHECK(complaint({.discard = 1}, {"at rest"}) == "");
  record.relative_viscosity.clear();
  CHECK(complaint({}, {"no sample"}) == "");
}

TEST_CASE("analysis: without walls the whole box is the bulk", "[analysis]") {
  SyntheticRun run{.times = 40, .cells = 12};
  auto record = run.record();
  record.flow = analysis::FlowOf::rest;
  record.walls = false;
  record.shear_rate = 0;
  record.interval = statistics::not_a_number;
  for (Index t = 0; t < 40; ++t)
    for (Index cell = 0; cell < 12; ++cell) run.memory->at(CellQuantity::centre, t, cell, 2) += 120 * static_cast<double>(cell - 6);  // unwrapped
  const auto found = analysis::analyse(record);
  CHECK(found.settings.wall_layer == 0);
  CHECK(found.estimate("phi_bulk").value == Approx(record.phi_effective));
  CHECK(found.curve("profile_phi").value.mean() == Approx(record.phi_effective));
}

TEST_CASE("analysis: a cell without cells", "[analysis]") {
  SyntheticRun run{.times = 200, .cells = 2};
  auto record = run.record();
  record.cells = nullptr;
  record.types.clear();
  record.type_of_cell.clear();
  record.relative_viscosity.assign(200, 1);
  const auto found = analysis::analyse(record);
  CHECK(found.estimate("whole_relative_viscosity").value == 1);
  for (const char* name : {"relative_viscosity", "deformation", "velocity_variance_x", "volume_drift_max", "contact_number", "gap_size"}) {
    CAPTURE(name);
    CHECK(std::isnan(found.estimate(name).value));
    CHECK(says(found.estimate(name).reason, "no cells"));
  }
}
