// Reading a run.h5 for its analysis: what is written comes back; gaps, missing parts and other files are told.
#include <fstream>

#include "core/error.hpp"
#include "io/run_file.hpp"
#include "io/run_record.hpp"
#include "tests/catch.hpp"
#include "tests/complaint.hpp"
#include "tests/scratch.hpp"
#include "tests/unit/synthetic_series.hpp"

using namespace corpuscle;
using namespace corpuscle::test;
using analysis::CellQuantity;
using Eigen::Index;

namespace {

LatticeParameters lattice_of_three() {
  LatticeParameters lattice;
  lattice.nodes = {24, 26, 32};
  lattice.radius = 4;
  lattice.viscosity = 1.0 / 6;
  lattice.shear_rate = 1e-4;
  lattice.capillary_number = 0.1;
  lattice.series_every = 100;
  lattice.cells.resize(2);
  lattice.cells[0].name = "red_cell";
  lattice.cells[0].count = 2;
  lattice.cells[0].effective_radius = 4.5;
  lattice.cells[0].volume = 100;
  lattice.cells[0].effective_volume = 130;
  lattice.cells[1].name = "bead";
  lattice.cells[1].count = 1;
  lattice.cells[1].effective_radius = 3;
  return lattice;
}

Sample numbered(std::int64_t step) {
  Sample sample;
  sample.step = step;
  const auto x = static_cast<double>(step);
  sample.strain = 1e-4 * x;
  sample.relative_viscosity = 1 + x;
  sample.bulk_particle_stress = {x, 0, x + 2, 0, x + 4, 0, 0, 0, x + 8};
  sample.mean_deformation = 0.1 * x;
  sample.cells.resize(3);
  for (std::size_t c = 0; c < 3; ++c) {
    const double y = x + 1e5 * static_cast<double>(c);
    sample.cells[c].centre = {y, y + 1, y + 2};
    sample.cells[c].stresslet[5] = -y;
    sample.cells[c].gyration[3] = 2 * y;
    sample.cells[c].volume = 3 * y;
  }
  return sample;
}

/// A run.h5 with samples at these steps.
void write(const std::filesystem::path& folder, const std::vector<std::int64_t>& steps, bool trajectories = true) {
  std::filesystem::create_directories(folder);
  RunFile run(folder / "run.h5", {"scene", "0.1.0", "abc", "CPU", 2, "Linux", "OpenMP"}, lattice_of_three(), {.trajectories = trajectories});
  for (const auto step : steps) run.append(numbered(step));
  run.flush();
}

}  // namespace

TEST_CASE("run record: numbers, series and trajectories", "[io][analysis]") {
  const ScratchFolder folder;
  write(folder / "a", {0, 100, 200, 300, 350});
  const auto record = read_run_record(folder / "a");
  CHECK(record.flow == analysis::FlowOf::shear);
  CHECK(record.walls);
  CHECK(record.box == std::array<double, 3>{24, 26, 32});
  CHECK(record.interval == Approx(0.01));
  CHECK(record.strain == Approx(0.035));
  CHECK(record.samples == 5);
  CHECK(record.times() == 4);  // the one at the end lies off the grid
  CHECK(record.warnings.empty());
  CHECK(record.relative_viscosity == std::vector<double>{1, 101, 201, 301});
  CHECK(record.bulk_stress[0][2] == 200);
  CHECK(record.bulk_stress[1][2] == 204);
  CHECK(record.bulk_stress[2][2] == 208);
  CHECK(record.bulk_stress[3][2] == 202);
  CHECK(record.cell_count() == 3);
  CHECK(record.mean_effective_radius() == Approx(4));
  CHECK(record.types.at(1).name == "bead");
  CHECK(record.type_of_cell == std::vector<std::int32_t>{0, 0, 1});
  REQUIRE(record.cells);
  const auto z = record.cells->component(CellQuantity::centre, 2, 1, 3);
  CHECK(z(0, 0) == 102);
  CHECK(z(2, 2) == 200302);
  CHECK(record.cells->component(CellQuantity::stresslet, 5, 0, 4)(3, 1) == -100300);
  CHECK(record.cells->component(CellQuantity::gyration, 3, 0, 4)(1, 0) == 200);
  CHECK(record.cells->component(CellQuantity::volume, 0, 0, 4)(1, 2) == 3 * 200100);
}

TEST_CASE("run record: gaps, and samples between the times", "[io][analysis]") {
  const ScratchFolder folder;
  write(folder / "a", {0, 100, 130, 400, 500});
  const auto record = read_run_record(folder / "a");
  CHECK(record.times() == 6);
  REQUIRE(record.warnings.size() == 2);
  CHECK(says(record.warnings[0], "1 samples lie between"));
  CHECK(says(record.warnings[1], "2 of 6 samples are missing"));
  CHECK(record.relative_viscosity[1] == 101);
  CHECK(std::isnan(record.relative_viscosity[2]));
  CHECK(record.relative_viscosity[4] == 401);
  const auto x = record.cells->component(CellQuantity::centre, 0, 0, 6);
  CHECK(x(1, 0) == 100);
  CHECK(std::isnan(x(3, 0)));
  CHECK(x(5, 1) == 100500);

  write(folder / "b", {0, 100, 100000});
  CHECK(complaint_lacks([&] { read_run_record(folder / "b"); }, {"1001 samples", "all but 3 are missing"}) == "");
  write(folder / "c", {0, 200, 100});
  CHECK(complaint_lacks([&] { read_run_record(folder / "c"); }, {"/series/step", "sample 2", "corpuscle check"}) == "");
}

TEST_CASE("run record: the shortest dataset of an unfinished write counts", "[io][analysis]") {
  const ScratchFolder folder;
  write(folder / "a", {0, 100, 200, 300});
  {
    auto file = hdf5::File::open_for_append(folder / "a/run.h5");
    file.set_row_count("/cells/stresslet", 2);
    file.close();
  }
  const auto record = read_run_record(folder / "a");
  CHECK(record.times() == 2);
  CHECK(record.cells->component(CellQuantity::centre, 0, 0, 2)(1, 0) == 100);
}

TEST_CASE("run record: without trajectories, samples, or a file", "[io][analysis]") {
  const ScratchFolder folder;
  write(folder / "a", {0, 100}, false);
  CHECK_FALSE(read_run_record(folder / "a").cells);
  write(folder / "b", {});
  CHECK(read_run_record(folder / "b").times() == 0);
  CHECK(complaint_lacks([&] { read_run_record(folder / "nowhere"); }, {"nowhere", "no such directory"}) == "");
  std::filesystem::create_directories(folder / "empty");
  CHECK(complaint_lacks([&] { read_run_record(folder / "empty"); }, {"empty", "no run.h5"}) == "");
  std::filesystem::create_directories(folder / "text");
  std::ofstream(folder / "text/run.h5") << "no HDF5";
  CHECK(complaint_lacks([&] { read_run_record(folder / "text"); }, {"text", "can't be used", "corpuscle check"}) == "");
  std::filesystem::create_directories(folder / "other");
  {
    auto file = hdf5::File::create(folder / "other/run.h5");
    file.set_attribute("/", "format", "something else");
    file.close();
  }
  CHECK(complaint_lacks([&] { read_run_record(folder / "other"); }, {"something else", "corpuscle run 1"}) == "");
  write(folder / "cut", {0, 100, 200});
  std::filesystem::resize_file(folder / "cut/run.h5", std::filesystem::file_size(folder / "cut/run.h5") / 2);
  CHECK(complaint_lacks([&] { read_run_record(folder / "cut"); }, {"cut", "can't be used"}) == "");
}
