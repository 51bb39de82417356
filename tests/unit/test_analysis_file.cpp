// analysis.json and analysis.md as a reader finds them.
#include <fstream>
#include <nlohmann/json.hpp>

#include "io/analysis_file.hpp"
#include "physics/analysis/analyse.hpp"
#include "tests/catch.hpp"
#include "tests/complaint.hpp"
#include "tests/scratch.hpp"
#include "tests/unit/synthetic_run.hpp"

using namespace corpuscle;
using namespace corpuscle::test;

TEST_CASE("analysis.json: everything under its name, NaN as null", "[io][analysis]") {
  SyntheticRun run{.times = 400, .cells = 12};
  auto record = run.record();
  record.warnings.push_back("a warning");
  const auto found = analysis::analyse(record, {.wall_layer = 2, .mean_flow = analysis::MeanFlow::uniform, .discard = 5});
  const auto json = nlohmann::json::parse(analysis_json(record, found).dump());
  CHECK(json["format"] == "corpuscle-analysis-1");
  CHECK(json["run"]["cell_count"] == 12);
  CHECK(json["run"]["effective_radius"].get<double>() == Approx(5.25));
  CHECK(json["run"]["box"] == std::vector<double>{40, 40, 60});
  CHECK(json["run"]["sample_interval"].get<double>() == Approx(0.1));
  CHECK(json["settings"]["mean_flow"] == "uniform");
  CHECK(json["settings"]["wall_layer"] == 2.0);
  CHECK(json["settings"]["discarded_strain"].get<double>() == Approx(5));
  CHECK(json["equilibration"]["converged"] == true);
  CHECK(json["warnings"][0] == "a warning");

  CHECK(json["estimates"].size() == found.estimates.size());
  const auto& viscosity = json["estimates"]["relative_viscosity"];
  CHECK(viscosity["value"].get<double>() == found.estimate("relative_viscosity").value);
  for (const char* key : {"error", "unit", "correlation_time", "effective_samples", "converged", "reason", "description"}) CHECK(viscosity.contains(key));
  CHECK(json["estimates"]["half_turns"]["value"].is_null());
  CHECK(json["estimates"]["half_turns"]["reason"] == "no cell tumbles");
  CHECK(json["estimates"]["volume_drift_max"]["error"].is_null());

  CHECK(json["curves"].size() == found.curves.size());
  for (const auto& [name, curve] : json["curves"].items()) {
    CAPTURE(name);
    CHECK(curve["x"].size() == curve["value"].size());
    CHECK(curve["x"].size() == curve["error"].size());
    CHECK(curve["x"].size() > 3);
    CHECK(curve["x"].size() <= 150);
    for (const char* key : {"x_unit", "unit", "x_label", "label", "trusted_until", "converged", "reason", "description"}) CHECK(curve.contains(key));
  }
  const auto& fit = json["fits"]["vacf_y_stretched_exponential"];
  CHECK(fit["curve"] == "vacf_y");
  CHECK(fit["parameters"]["time"]["value"].get<double>() > 0);
  CHECK(fit["to"].is_number());
  CHECK(json["tensors"]["orientation"]["value"].size() == 3);
  CHECK(json["tensors"]["orientation"]["value"][1].size() == 3);
}

TEST_CASE("analysis: every curve of a long run is thinned to 150 points", "[io][analysis]") {
  SyntheticRun run{.times = 12000, .cells = 2, .box = {40, 40, 500}};
  run.deviation[2] = 0;
  const auto found = analysis::analyse(run.record(), {.wall_layer = 0, .discard = 0});
  for (const auto& item : found.curves) {
    CAPTURE(item.name);
    CHECK(item.curve.x.size() <= 150);
  }
  CHECK(found.curve("msd_y").x.maxCoeff() == Approx(300));
}

TEST_CASE("analysis.md: numbers with errors, and why some can't be trusted", "[io][analysis]") {
  SyntheticRun run{.times = 400, .cells = 12};
  const auto record = run.record();
  auto found = analysis::analyse(record, {.wall_layer = 2});
  found.estimate("relative_viscosity") = {.value = 4.6903, .error = 0.0461, .correlation_time = 0.5, .effective_samples = 30, .converged = true};
  found.estimate("gap_size") = {.value = 1, .error = 0.1, .reason = "some reason"};
  found.estimate("gap_size_lattice") = {.value = 5, .error = 0.5, .reason = "some reason"};
  found.warnings = {"a warning"};
  const std::string page = analysis_page(record, found);
  CHECK(says(page, "| relative_viscosity | 4.690 ± 0.046 |  | 0.5 | 30 | yes |"));
  CHECK(says(page, "| gap_size | 1.00 ± 0.10 | r |"));
  CHECK(says(page, "- gap_size, gap_size_lattice: some reason\n"));
  CHECK(says(page, "## Warnings\n\n- a warning\n"));
  CHECK(says(page, "12 cells"));
  CHECK(says(page, "| msd_y_line | intercept + slope t |"));
}

TEST_CASE("analysis.md: digits of a value with its error", "[io][analysis]") {
  CHECK(with_error(1.23456, 0.0123) == "1.235 ± 0.012");
  CHECK(with_error(-1.23456, 0.5) == "-1.23 ± 0.50");
  CHECK(with_error(123.4, 20) == "123 ± 20");
  CHECK(with_error(0.00001234, 0.0000012) == "(1.23 ± 0.12)e-5");
  CHECK(with_error(3.2e7, 1e6) == "(3.20 ± 0.10)e7");
  CHECK(with_error(0.25, statistics::not_a_number) == "0.25");
  CHECK(with_error(0.25, 0) == "0.25");
  CHECK(with_error(0, 0.01) == "0.000 ± 0.010");
  CHECK(with_error(statistics::not_a_number, 1) == "-");
}

TEST_CASE("analysis.json replaces nothing but an analysis", "[io][analysis]") {
  const ScratchFolder folder;
  CHECK_NOTHROW(require_replaceable(folder / "new.json", analysis_format, {".md"}));
  std::ofstream(folder / "analysis.json") << R"({"format": "corpuscle-analysis-1"})";
  CHECK_NOTHROW(require_replaceable(folder / "analysis.json", analysis_format, {".md"}));
  std::ofstream(folder / "summary.json") << R"({"capillary_number": 1})";
  CHECK(complaint_lacks([&] { require_replaceable(folder / "summary.json", analysis_format, {}); }, {"summary.json", "would be lost"}) == "");
  std::ofstream(folder / "run.h5") << "data";
  CHECK_NOTHROW(require_replaceable(folder / "run.json", analysis_format, {".md"}));
  CHECK(complaint_lacks([&] { require_replaceable(folder / "run.json", analysis_format, {".md", ".h5"}); }, {"run.h5", "would be lost"}) == "");
}
