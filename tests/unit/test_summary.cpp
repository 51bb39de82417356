// The summary's means against constructed series, and summary.json as a reader finds it.
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/error.hpp"
#include "io/summary.hpp"
#include "tests/catch.hpp"
#include "tests/contains.hpp"
#include "tests/scratch.hpp"

using namespace corpuscle;

namespace {

LatticeParameters lattice_of(std::int64_t cells) {
  LatticeParameters lattice;
  lattice.capillary_number = 0.1;
  lattice.reynolds_number = 0.05;
  lattice.phi_geometric = 0.25;
  lattice.phi_nominal = 0.25;
  lattice.phi_effective = 0.3;
  lattice.cells.resize(1);
  lattice.cells[0].name = "bead";
  lattice.cells[0].effective_radius = 8.4;
  lattice.cells[0].area = 200;
  lattice.cells[0].count = cells;
  return lattice;
}

/// 101 samples, strain 0 ... 10; the viscosity is 9 in the first fifth, then alternates between 1.9 and 2.1.
std::vector<Sample> stepped_series() {
  std::vector<Sample> samples;
  for (int i = 0; i <= 100; ++i) {
    Sample sample;
    sample.step = 1000 * i;
    sample.strain = 0.1 * i;
    sample.relative_viscosity = i < 20 ? 9 : 2 + (i % 2 == 0 ? 0.1 : -0.1);
    sample.bulk_relative_viscosity = sample.relative_viscosity;
    sample.wall_relative_viscosity = std::numeric_limits<double>::quiet_NaN();
    sample.normal_stress_difference_1 = 0.5;
    sample.volume_drift_max = i == 7 ? 0.02 : 0.001;
    sample.area_drift_max = 0.003;
    samples.push_back(sample);
  }
  return samples;
}

nlohmann::json read_json(const std::filesystem::path& path) { return nlohmann::json::parse(std::ifstream(path)); }

}  // namespace

TEST_CASE("summary: means leave the discarded part out", "[io]") {
  const auto summary = summarise(stepped_series(), lattice_of(8), 0.25);
  CHECK(summary.averaged_from_strain == Approx(2.5));
  CHECK(summary.averaged_to_strain == Approx(10));
  CHECK(summary.averaged_samples == 76);
  CHECK(summary.relative_viscosity.mean == Approx(2).margin(0.002));
  CHECK(summary.relative_viscosity.error < 0.02);
  CHECK(std::isnan(summary.wall_relative_viscosity.mean));
  CHECK(summary.normal_stress_difference_1.mean == 0.5);
  CHECK(summary.normal_stress_difference_1.error == 0);
  CHECK(summary.volume_drift_max == 0.02);  // of the whole run
  CHECK(summary.steps == 100000);
  CHECK(summary.strain == Approx(10));
  CHECK(summary.cell_count == 8);
  CHECK(summary.converged);
  CHECK(std::isnan(summary.intrinsic_viscosity));
  CHECK(summarise(stepped_series(), lattice_of(8), 0).relative_viscosity.mean > 3);
}

TEST_CASE("summary: usable while the run goes on", "[io]") {
  SeriesSummary series(lattice_of(8), 0.25);
  CHECK(std::isnan(series.relative_viscosity().mean));
  CHECK(series.result().averaged_samples == 0);
  for (const auto& sample : stepped_series()) series.add(sample);
  CHECK(series.relative_viscosity().mean == series.result().relative_viscosity.mean);
  auto later = stepped_series().back();
  for (int i = 0; i < 100; ++i) {
    later.step += 1000;
    series.add(later);
    CHECK(series.relative_viscosity().mean == Approx(series.result().relative_viscosity.mean).epsilon(0.1));
  }
}

TEST_CASE("summary: one cell adds its shape and the intrinsic viscosity", "[io]") {
  std::vector<Sample> samples = stepped_series();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    // Ellipsoid of semi-axes 5, 3, 2 whose inclination alternates around 90 degrees.
    const double angle = std::numbers::pi / 2 + (i % 2 == 0 ? 0.1 : -0.1);
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    CellSample cell;
    cell.gyration = {(25 * c * c + 4 * s * s) / 5, 9.0 / 5, (25 * s * s + 4 * c * c) / 5, 0, (25 - 4) * s * c / 5, 0};
    cell.area = 210;
    samples[i].cells = {cell};
  }
  const auto summary = summarise(samples, lattice_of(1), 0.25);
  CHECK(summary.deformation == Approx(3.0 / 7));
  CHECK(std::abs(summary.inclination) == Approx(std::numbers::pi / 2).epsilon(0.01));
  CHECK(summary.area_ratio == Approx(1.05));
  CHECK(summary.intrinsic_viscosity == Approx(4).epsilon(0.01));
}

TEST_CASE("summary.json: keys, null for missing numbers, whole or not at all", "[io]") {
  const ScratchFolder folder;
  auto summary = summarise(stepped_series(), lattice_of(8), 0.25);
  summary.wall_seconds = 12.5;
  summary.mlups = 20;
  summary.threads = 2;
  summary.bytes_peak = 5000000000;
  summary.stopped_by = "interrupt";
  write_summary(folder / "summary.json", summary);
  CHECK_FALSE(std::filesystem::exists(folder / "summary.json.tmp"));
  const auto json = read_json(folder / "summary.json");
  for (const char* key :
       {"capillary_number", "reynolds_number", "phi_geometric", "phi_nominal", "phi_effective", "effective_radius", "cell_count", "strain", "steps", "relative_viscosity",
        "relative_viscosity_error", "wall_relative_viscosity", "wall_relative_viscosity_error", "bulk_relative_viscosity",
        "bulk_relative_viscosity_error", "normal_stress_difference_1", "normal_stress_difference_1_error", "normal_stress_difference_2",
        "normal_stress_difference_2_error", "volume_drift_max", "area_drift_max", "wall_seconds", "mlups", "threads", "bytes_peak",
        "averaged_from_strain", "averaged_to_strain", "converged", "stopped_by"}) {
    CAPTURE(key);
    CHECK(json.contains(key));
  }
  CHECK(json["wall_relative_viscosity"].is_null());
  CHECK(json["effective_radius"]["bead"] == 8.4);
  CHECK(json["relative_viscosity"].get<double>() == summary.relative_viscosity.mean);
  CHECK(json["bytes_peak"] == 5000000000);
  CHECK(json["stopped_by"] == "interrupt");
  CHECK(json["converged"] == true);
  CHECK_FALSE(json.contains("deformation"));
  CHECK_FALSE(json.contains("unit_length_m"));

  auto lattice = lattice_of(8);
  lattice.si = {5e-7, 2e-10, 4e-6};
  write_summary(folder / "summary.json", summarise(stepped_series(), lattice, 0.25));
  const auto in_si = read_json(folder / "summary.json");
  CHECK(in_si["unit_length_m"] == 5e-7);
  CHECK(in_si["unit_force_N"] == 2e-10);
  CHECK(in_si["unit_time_s"] == 4e-6);

  auto single = summary;
  single.cell_count = 1;
  write_summary(folder / "summary.json", single);  // replaces
  CHECK(read_json(folder / "summary.json").contains("intrinsic_viscosity"));
  CHECK_THROWS_WITH(write_summary(folder / "missing/summary.json", summary),
                    Contains("missing/summary.json") && Contains("No such file"));
  CHECK_THROWS_AS(write_summary(folder / "missing/summary.json", summary), OutputError);
}
