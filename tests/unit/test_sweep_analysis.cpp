// The files of an analysed sweep as a reader finds them.
#include <fstream>
#include <sstream>

#include "io/analysis_file.hpp"
#include "io/hdf5.hpp"
#include "io/sweep_analysis.hpp"
#include "physics/analysis/analyse.hpp"
#include "tests/catch.hpp"
#include "tests/complaint.hpp"
#include "tests/scratch.hpp"
#include "tests/unit/synthetic_run.hpp"

using namespace corpuscle;
using namespace corpuscle::test;

namespace {

/// Four runs that differ by capillary number, and one with a comma in its name that has no bulk.
SweepAnalysis made_up() {
  std::vector<AnalysedRun> runs;
  for (int i = 0; i < 5; ++i) {
    SyntheticRun run{.times = 400, .cells = 12, .viscosity = 2.0 + i, .seed = static_cast<std::uint64_t>(i + 1)};
    auto record = run.record();
    record.capillary_number = 0.1 / (1 + i);
    const auto found = analysis::analyse(record, {.wall_layer = i == 4 ? 6.0 : 2.0, .discard = 0});
    runs.push_back({i == 4 ? "odd, name" : "run" + std::to_string(i), analysis_json(record, found)});
  }
  return combine(std::move(runs), {"one warning"});
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::stringstream stream(text);
  for (std::string part; std::getline(stream, part, at);) parts.push_back(part);
  return parts;
}

}  // namespace

TEST_CASE("sweep analysis: JSON with runs, flow curves and what they tell", "[io][analysis]") {
  const auto sweep = made_up();
  const auto json = nlohmann::json::parse(sweep_analysis_json(sweep).dump());
  CHECK(json["format"] == "corpuscle-sweep-analysis-1");
  REQUIRE(json["runs"].size() == 5);
  CHECK(json["runs"][1]["directory"] == "run1");
  CHECK(json["runs"][1]["run"]["capillary_number"].get<double>() == Approx(0.05));
  CHECK(json["runs"][1]["estimates"]["relative_viscosity"]["value"].is_number());
  CHECK(json["runs"][4]["estimates"]["relative_viscosity"]["value"].is_null());
  CHECK(json["runs"][1]["fits"]["msd_y_line"]["parameters"].contains("slope"));
  REQUIRE(json["flow_curves"].size() == 1);
  CHECK(json["flow_curves"][0]["runs"] == std::vector<std::string>{"odd, name", "run3", "run2", "run1", "run0"});
  CHECK(json["flow_curves"][0]["shear_thinning"]["parameters"].contains("exponent"));
  CHECK(json["flow_curves"][0]["yield_stress"]["model"] == "yield_stress/Ca + prefactor Ca^-exponent");
  CHECK(json["critical_volume_fraction"]["value"].is_null());
  CHECK(json["critical_volume_fraction"]["reason"] != "");
  CHECK(json["gap_radius"]["converged"] == false);
  CHECK(json["warnings"][0] == "one warning");

  const std::string page = sweep_analysis_page(sweep);
  CHECK(says(page, "| run1 | 0.05 |"));
  CHECK(says(page, "- one warning"));
  CHECK(says(page, "Flow curves"));
}

TEST_CASE("sweep analysis: CSV and HDF5 hold the same numbers", "[io][analysis]") {
  const auto sweep = made_up();
  const auto lines = split(sweep_analysis_csv(sweep), '\n');
  REQUIRE(lines.size() == 6);
  const auto head = split(lines[0], ','), second = split(lines[2], ',');
  REQUIRE(head.size() == second.size());
  CHECK(lines[5].starts_with("\"odd, name\","));
  const auto column = std::find(head.begin(), head.end(), "velocity_variance_y") - head.begin();
  const double variance = std::stod(second.at(static_cast<std::size_t>(column)));
  CHECK(variance == Approx(sweep.runs[1].analysis["estimates"]["velocity_variance_y"]["value"].get<double>()));
  CHECK(head.at(static_cast<std::size_t>(column) + 1) == "velocity_variance_y_error");
  CHECK(head.at(static_cast<std::size_t>(column) + 2) == "velocity_variance_y_converged");

  const ScratchFolder folder;
  write_sweep_analysis_h5(folder / "analysis.h5", sweep);
  const auto file = hdf5::File::open_for_reading(folder / "analysis.h5");
  CHECK(file.string_attribute("/", "format") == "corpuscle-sweep-analysis-1");
  CHECK(file.read_strings("/runs/directory").at(4) == "odd, name");
  CHECK(file.read<double>("/runs/capillary_number").values.at(1) == Approx(0.05));
  CHECK(file.read<double>("/estimates/velocity_variance_y/value").values.at(1) == Approx(variance));
  CHECK(std::isnan(file.read<double>("/estimates/relative_viscosity/value").values.at(4)));
  CHECK(file.read<std::uint8_t>("/estimates/relative_viscosity/converged").values.at(4) == 0);
  CHECK(file.string_attribute("/estimates/gap_size", "unit") == "r");
  CHECK_FALSE(std::filesystem::exists(folder / "analysis.h5.tmp"));
}

TEST_CASE("sweep analysis: other files are refused", "[io][analysis]") {
  const ScratchFolder folder;
  std::ofstream(folder / "a.json") << "{}";
  std::ofstream(folder / "b.json") << "no JSON";
  for (const char* name : {"a.json", "b.json", "none.json"}) CHECK(complaint_lacks([&] { read_analysis(folder / name); }, {name, "corpuscle analyse"}) == "");
  auto sweep = made_up();
  sweep.runs[0].analysis["estimates"].erase("phi_bulk");
  CHECK(complaint_lacks([&] { combine(sweep.runs, {}); }, {"run0/analysis.json", "remove it"}) == "");
}
