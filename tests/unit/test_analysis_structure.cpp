// Analysis: volume fractions, neighbours on a lattice, several types.
#include "physics/analysis/analyse.hpp"
#include "tests/catch.hpp"
#include "tests/unit/synthetic_run.hpp"

using namespace corpuscle;
using namespace corpuscle::test;
using analysis::CellQuantity;
using Eigen::Index;

namespace {

/// Cells on a simple cubic lattice of spacing `step`, all times alike but for a jitter along x.
analysis::RunRecord on_lattice(SyntheticRun& run, double step) {
  const auto along = [&](double length) { return static_cast<Index>(std::lround(length / step)); };
  const Index nx = along(run.box[0]), ny = along(run.box[1]), nz = along(run.box[2]);
  run.cells = nx * ny * nz;
  auto record = run.record();
  Normal normal(3);
  for (Index t = 0; t < run.times; ++t) {
    for (Index cell = 0; cell < run.cells; ++cell) {
      const Index i = cell % nx, j = cell / nx % ny, k = cell / (nx * ny);
      const double at[3] = {(static_cast<double>(i) + 0.5) * step, (static_cast<double>(j) + 0.5) * step, (static_cast<double>(k) + 0.5) * step};
      for (int c = 0; c < 3; ++c) run.memory->at(CellQuantity::centre, t, cell, c) = at[c] + 0.02 * step * normal();
    }
  }
  return record;
}

}  // namespace

TEST_CASE("analysis: pair distribution and contacts of a cubic lattice", "[analysis]") {
  SyntheticRun run{.times = 40};
  const auto found = analysis::analyse(on_lattice(run, 10), {.wall_layer = 2, .discard = 0});  // 4 x 4 x 6 cells, neighbours at 2 and 2.83 radii
  const auto& g = found.curve("pair_distribution");
  Index peak = 0;
  g.value.head(24).maxCoeff(&peak);  // up to 2.4 radii
  CHECK(g.x[peak] == Approx(2).margin(0.1));
  CHECK(found.settings.contact_distance > 2.2);
  CHECK(found.settings.contact_distance < 2.7);
  CHECK(found.settings.contact_distance_from == "first minimum of g(r)");
  CHECK(found.estimate("contact_number").value == Approx(6));
}

TEST_CASE("analysis: contacts without a minimum of g(r)", "[analysis]") {
  SyntheticRun run{.times = 60, .cells = 12, .box = {60, 60, 60}};
  const auto found = analysis::analyse(run.record(), {.wall_layer = 1, .discard = 0});
  CHECK(found.settings.contact_distance == Approx(1.5 * 2 * 1.05));
  CHECK(says(found.settings.contact_distance_from, "1.5 effective diameters"));
  const double volume = 60.0 * 60 * 60;
  // Independent cells: 11 others, the ball between the walls less than whole.
  const double whole = 11 * 4.0 / 3 * 3.14159 * std::pow(1.5 * 2 * 1.05 * 5, 3) / volume;
  CHECK(found.estimate("contact_number").value < 1.6 * whole);
  CHECK(found.estimate("contact_number").value > 0.4 * whole);

  SyntheticRun narrow{.times = 60, .cells = 12, .box = {25, 25, 60}};
  CHECK(says(analysis::analyse(narrow.record(), {.wall_layer = 1, .discard = 0}).estimate("contact_number").reason, "half of the periodic box"));
}

TEST_CASE("analysis: volume fraction of the bulk, by type of cell", "[analysis]") {
  SyntheticRun run{.times = 40};
  auto record = on_lattice(run, 10);
  auto found = analysis::analyse(record, {.wall_layer = 2, .discard = 0});  // 4 of 6 layers in 40 of 60
  CHECK(found.estimate("phi_bulk_geometric").value == Approx(200.0 / 1000));
  CHECK(found.estimate("phi_bulk").value == Approx(250.0 / 1000));
  CHECK(found.curve("profile_phi").value.mean() == Approx(250.0 / 1000));
  CHECK(found.warnings.empty());

  record.types = {{.name = "red_cell", .count = 48, .effective_radius = 5, .volume = 200, .effective_volume = 250},
                  {.name = "bead", .count = 48, .effective_radius = 5, .volume = 200, .effective_volume = 300}};
  for (std::size_t cell = 0; cell < 96; cell += 2) record.type_of_cell[cell] = 1;
  found = analysis::analyse(record, {.wall_layer = 2, .discard = 0});
  CHECK(found.estimate("phi_bulk").value == Approx(275.0 / 1000));
  REQUIRE(found.warnings.size() == 1);
  CHECK(says(found.warnings[0], "2 types of cells"));
}
