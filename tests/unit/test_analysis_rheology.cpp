// Analysis: stresses of prescribed stresslets, in the bulk and without one.
#include "physics/analysis/analyse.hpp"
#include "tests/catch.hpp"
#include "tests/unit/synthetic_run.hpp"

using namespace corpuscle;
using namespace corpuscle::test;
using analysis::CellQuantity;
using Eigen::Index;

namespace {

constexpr analysis::AnalysisOptions from_start{.wall_layer = 2, .discard = 0};

/// The same stress by a loop: component `part` of the cells within the layers, over eta_0 shear_rate and the bulk's volume.
std::vector<double> stress_by_hand(SyntheticRun& run, const analysis::RunRecord& record, double layer, int part) {
  std::vector<double> series;
  for (Index t = 0; t < run.times; ++t) {
    double sum = 0;
    for (Index cell = 0; cell < run.cells; ++cell) {
      const double z = run.memory->at(CellQuantity::centre, t, cell, 2);
      if (z >= layer * run.radius && z <= run.box[2] - layer * run.radius) sum += run.memory->at(CellQuantity::stresslet, t, cell, part);
    }
    series.push_back(sum / (run.box[0] * run.box[1] * (run.box[2] - 2 * layer * run.radius)) / (record.viscosity * record.shear_rate));
  }
  return series;
}

double mean(const std::vector<double>& series) {
  double sum = 0;
  for (const double x : series) sum += x;
  return sum / static_cast<double>(series.size());
}

}  // namespace

TEST_CASE("analysis: stresses of the bulk are those of the stresslets in it", "[analysis]") {
  SyntheticRun run{.times = 600, .cells = 30};
  const auto record = run.record();
  const auto found = analysis::analyse(record, from_start);
  const auto xx = stress_by_hand(run, record, 2, 0), yy = stress_by_hand(run, record, 2, 4), zz = stress_by_hand(run, record, 2, 8),
             xz = stress_by_hand(run, record, 2, 2);
  CHECK(found.estimate("relative_viscosity").value == Approx(1 + mean(xz)));
  CHECK(found.estimate("normal_stress_difference_1").value == Approx(mean(xx) - mean(zz)));
  CHECK(found.estimate("normal_stress_difference_2").value == Approx(mean(zz) - mean(yy)));
  CHECK(found.estimate("particle_pressure").value == Approx(-(mean(xx) + mean(yy) + mean(zz)) / 3));
  double squares = 0;
  for (const double s : xz) squares += (s - mean(xz)) * (s - mean(xz));
  CHECK(found.estimate("bulk_stress_fluctuation").value == Approx(std::sqrt(squares / 600) / mean(xz)));
  CHECK(found.estimate("whole_relative_viscosity").value == Approx(1.8));
  CHECK(found.estimate("volume_drift_max").value == 0.01);
  CHECK(found.estimate("area_drift_max").value == 0.003);
  CHECK(found.settings.discarded_strain == 0);
}

TEST_CASE("analysis: viscosity and stress relaxation of cells that all stay in the bulk", "[analysis]") {
  // Without walls' layers every cell counts: the mean stress is the prescribed one, its fluctuation that of one cell over the root of their number.
  SyntheticRun run{.times = 8000, .cells = 16};
  run.deviation[2] = 0;
  const auto found = analysis::analyse(run.record(), {.wall_layer = 0, .discard = 0});
  agrees(found.estimate("relative_viscosity"), 1.8);
  CHECK(found.estimate("relative_viscosity").converged);
  agrees(found.estimate("normal_stress_difference_1"), 0.8 * 0.6);
  agrees(found.estimate("normal_stress_difference_2"), -0.8 * 0.1);
  agrees(found.estimate("particle_pressure"), -0.8 * 0.1 / 3);
  agrees(found.estimate("bulk_stress_fluctuation"), 0.3 / 4);
  agrees(found.estimate("stress_relaxation_time"), run.relaxation_time());
  CHECK(found.estimate("stress_relaxation_time").error < 0.2 * run.relaxation_time());
  const auto& correlation = found.curve("stress_autocorrelation");
  CHECK(correlation.value[0] == Approx(1).epsilon(1e-12));  // x/x of sums in another order
  CHECK(std::abs(correlation.value[5] - std::exp(-1)) < 5 * correlation.error[5]);
}

TEST_CASE("analysis: without trajectories there is the stress of the series, in its layer only", "[analysis]") {
  SyntheticRun run{.times = 200, .cells = 5};
  auto record = run.record();
  record.cells = nullptr;
  auto found = analysis::analyse(record, {.wall_layer = 4, .discard = 0});
  CHECK(found.estimate("relative_viscosity").value == Approx(1.8));
  CHECK(says(found.estimate("deformation").reason, "trajectories"));
  CHECK(says(found.estimate("velocity_variance_y").reason, "trajectories"));
  CHECK(says(found.estimate("contact_number").reason, "trajectories"));
  found = analysis::analyse(record, {.wall_layer = 3, .discard = 0});
  CHECK(std::isnan(found.estimate("relative_viscosity").value));
  CHECK(says(found.estimate("relative_viscosity").reason, "4 radii"));
  CHECK(found.estimate("wall_relative_viscosity").value == Approx(1.8));
}

TEST_CASE("analysis: what rest, channel flow and thick layers leave", "[analysis]") {
  SyntheticRun run{.times = 200, .cells = 6};
  auto record = run.record();
  auto found = analysis::analyse(record, {.wall_layer = 6});
  CHECK(says(found.estimate("relative_viscosity").reason, "no bulk is left"));
  CHECK(says(found.estimate("deformation").reason, "--wall-layer"));
  CHECK(says(found.estimate("gap_size").reason, "no bulk is left"));
  CHECK(says(found.estimate("relative_viscosity_local_rate").reason, "no bulk is left"));
  CHECK(found.estimate("whole_relative_viscosity").value == Approx(1.8));

  record.flow = analysis::FlowOf::poiseuille;
  found = analysis::analyse(record, from_start);
  CHECK(says(found.estimate("relative_viscosity").reason, "channel flow"));
  CHECK(says(found.estimate("shear_rate_bulk").reason, "channel flow"));
  CHECK(says(found.estimate("wall_relative_viscosity").reason, "body force"));
  CHECK(says(found.estimate("gap_size").reason, "channel flow"));
  CHECK(found.estimate("velocity_variance_z").value > 0);

  record.flow = analysis::FlowOf::rest;
  record.shear_rate = 0;
  record.interval = statistics::not_a_number;
  found = analysis::analyse(record, {.wall_layer = 2});
  for (const char* name : {"relative_viscosity", "wall_relative_viscosity", "velocity_variance_x", "gap_size", "diffusivity_msd_y", "stress_fluctuation", "half_turns"}) {
    CAPTURE(name);
    CHECK(std::isnan(found.estimate(name).value));
    CHECK(says(found.estimate(name).reason, "at rest"));
  }
  CHECK(found.estimate("deformation").value == Approx(0.5));
  CHECK(found.estimate("contact_number").value >= 0);
}
