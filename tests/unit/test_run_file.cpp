// run.h5: metadata, series and cells as written, flushed, read back, resumed.
#include <chrono>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "io/run_file.hpp"
#include "tests/catch.hpp"
#include "tests/scratch.hpp"

using namespace corpuscle;

namespace {

LatticeParameters small_lattice() {
  LatticeParameters lattice;
  lattice.nodes = {24, 24, 32};
  lattice.radius = 4;
  lattice.viscosity = 1.0 / 6;
  lattice.shear_rate = 1e-4;
  lattice.capillary_number = 0.1;
  lattice.phi_geometric = 0.02;
  lattice.phi_effective = 0.03;
  lattice.steps = 2000;
  lattice.limits = {{"membrane stability", 1e-4}, {"mach_max", 2e-4}};
  lattice.cells.resize(2);
  lattice.cells[0].name = "red_cell";
  lattice.cells[0].count = 2;
  lattice.cells[0].moduli.shear = 0.1;
  lattice.cells[1].name = "bead";
  lattice.cells[1].count = 1;
  lattice.cells[1].stretching_force = 0.2;
  lattice.si.length = 1e-6;  // without viscosity and modulus: only this is known
  return lattice;
}

RunMetadata some_metadata() { return {"[box]\nsize = [6, 6, 8]\n", "0.1.0", "abc123", "some CPU", 2, "Linux", "OpenMP"}; }

/// A sample in which every number tells where it belongs.
Sample numbered(std::int64_t step, std::size_t cells = 3) {
  Sample sample;
  sample.step = step;
  const auto x = static_cast<double>(step);
  sample.strain = 1e-4 * x;
  for (std::size_t i = 0; i < 9; ++i) sample.particle_stress[i] = x + 0.1 * static_cast<double>(i);
  sample.wall_shear_stress = {std::numeric_limits<double>::quiet_NaN(), x};
  sample.relative_viscosity = 1 + x;
  sample.normal_stress_difference_2 = -x;
  sample.velocity_max = 1e-3;
  sample.cells.resize(cells);
  for (std::size_t c = 0; c < cells; ++c) {
    const double y = x + 1000 * static_cast<double>(c);
    sample.cells[c].centre = {y, y + 1, y + 2};
    sample.cells[c].stresslet[5] = y;
    sample.cells[c].volume = y;
  }
  return sample;
}

constexpr RunFileOptions never_by_itself{.trajectories = true, .flush_every = std::chrono::hours(1)};

}  // namespace

TEST_CASE("RunFile: metadata and lattice parameters are stored", "[io]") {
  const ScratchFolder folder;
  { RunFile run(folder / "run.h5", some_metadata(), small_lattice()); }
  const auto file = hdf5::File::open_for_reading(folder / "run.h5");
  CHECK(file.string_attribute("/", "scene") == some_metadata().scene);
  CHECK(file.string_attribute("/", "git_revision") == "abc123");
  CHECK(file.number_attribute("/", "cores") == 2);
  CHECK(file.numbers_attribute("/lattice", "nodes") == std::vector<double>{24, 24, 32});
  CHECK(file.number_attribute("/lattice", "viscosity") == 1.0 / 6);
  CHECK(file.number_attribute("/lattice/cell_types/0", "shear_modulus") == 0.1);
  CHECK(file.string_attribute("/lattice/cell_types/1", "name") == "bead");
  CHECK(file.number_attribute("/lattice/cell_types/1", "stretching_force") == 0.2);
  CHECK(file.number_attribute("/lattice", "unit_length_m") == 1e-6);
  CHECK_THROWS(file.number_attribute("/lattice", "unit_time_s"));
  CHECK(file.string_attribute("/lattice/limits/0", "name") == "membrane stability");
  CHECK(file.read<std::int32_t>("/cells/type").values == std::vector<std::int32_t>{0, 0, 1});
  CHECK(file.read_strings("/cells/type_names") == std::vector<std::string>{"red_cell", "bead"});
  for (const char* name : {"/series/step", "/series/wall_shear_stress", "/cells/centre"}) {
    CHECK_FALSE(file.string_attribute(name, "unit").empty());
    CHECK_FALSE(file.string_attribute(name, "description").empty());
    CHECK(file.shape(name).at(0) == 0);
  }
}

TEST_CASE("RunFile: samples arrive in the file with each flush, not before", "[io]") {
  const ScratchFolder folder;
  const auto path = folder / "run.h5";
  RunFile run(path, some_metadata(), small_lattice(), never_by_itself);
  for (int step = 0; step < 5; ++step) run.append(numbered(10 * step));
  CHECK(read_series(path).empty());
  run.flush();
  CHECK(read_series(path).size() == 5);
  run.append(numbered(50));
  run.flush();
  run.flush();  // nothing to write

  const auto samples = read_series(path);
  REQUIRE(samples.size() == 6);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto expected = numbered(10 * static_cast<std::int64_t>(i));
    CHECK(samples[i].step == expected.step);
    CHECK(samples[i].strain == expected.strain);
    CHECK(samples[i].particle_stress == expected.particle_stress);
    CHECK(std::isnan(samples[i].wall_shear_stress[0]));
    CHECK(samples[i].wall_shear_stress[1] == expected.wall_shear_stress[1]);
    CHECK(samples[i].relative_viscosity == expected.relative_viscosity);
    CHECK(samples[i].normal_stress_difference_2 == expected.normal_stress_difference_2);
    CHECK(samples[i].velocity_max == expected.velocity_max);
  }
  const auto file = hdf5::File::open_for_reading(path);
  CHECK(file.shape("/cells/centre") == hdf5::Shape{6, 3, 3});
  CHECK(file.shape("/cells/gyration") == hdf5::Shape{6, 3, 6});
  CHECK(file.shape("/cells/stresslet") == hdf5::Shape{6, 3, 3, 3});
  CHECK(file.shape("/cells/volume") == hdf5::Shape{6, 3});
  const auto centre = file.read<double>("/cells/centre").values;
  CHECK(centre[(4 * 3 + 2) * 3 + 1] == 2041);  // sample 4 (step 40), cell 2, y
  const auto stresslet = file.read<double>("/cells/stresslet").values;
  CHECK(stresslet[(1 * 3 + 1) * 9 + 5] == 1010);  // sample 1, cell 1, entry yz
}

TEST_CASE("RunFile: flushes by itself by time and by size, and when it goes away", "[io]") {
  const ScratchFolder folder;
  {
    RunFile run(folder / "time.h5", some_metadata(), small_lattice(), {.flush_every = std::chrono::seconds(0)});
    run.append(numbered(1));
    CHECK(read_series(folder / "time.h5").size() == 1);
  }
  {
    RunFile run(folder / "size.h5", some_metadata(), small_lattice(), {.flush_every = std::chrono::hours(1), .buffer_bytes = 3000});
    for (int step = 0; step < 4; ++step) run.append(numbered(step));
    CHECK_FALSE(read_series(folder / "size.h5").empty());
  }
  CHECK(read_series(folder / "size.h5").size() == 4);
}

TEST_CASE("RunFile: without trajectories there is no /cells", "[io]") {
  const ScratchFolder folder;
  auto options = never_by_itself;
  options.trajectories = false;
  {
    RunFile run(folder / "run.h5", some_metadata(), small_lattice(), options);
    run.append(numbered(1, 0));
  }
  CHECK_FALSE(hdf5::File::open_for_reading(folder / "run.h5").exists("/cells"));
  CHECK(read_series(folder / "run.h5").size() == 1);

  auto no_cells = small_lattice();
  no_cells.cells.clear();
  { RunFile run(folder / "fluid.h5", some_metadata(), no_cells); }
  CHECK_FALSE(hdf5::File::open_for_reading(folder / "fluid.h5").exists("/cells"));
}

TEST_CASE("RunFile: a resumed run continues after the checkpoint's step", "[io]") {
  const ScratchFolder folder;
  const auto path = folder / "run.h5";
  {
    RunFile run(path, some_metadata(), small_lattice(), never_by_itself);
    for (int step = 0; step <= 100; step += 10) run.append(numbered(step));
  }
  {
    auto run = RunFile::resume(path, 45, never_by_itself);
    CHECK_THROWS_AS(run.append(numbered(50, 2)), std::logic_error);
    for (int step = 50; step <= 60; step += 10) run.append(numbered(step));
  }
  const auto samples = read_series(path);
  REQUIRE(samples.size() == 7);
  for (std::size_t i = 0; i < samples.size(); ++i) CHECK(samples[i].step == 10 * static_cast<std::int64_t>(i));
  CHECK(hdf5::File::open_for_reading(path).shape("/cells/area") == hdf5::Shape{7, 3});
  CHECK_THROWS_AS(RunFile::resume(folder / "none.h5", 0), OutputError);
}
