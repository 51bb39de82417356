// corpuscle analyse DIR: all observables of a run, or of all runs of a sweep and what they tell together.
#include "physics/analysis/analyse.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/analyse.hpp"
#include "app/commands.hpp"
#include "core/error.hpp"
#include "core/version.hpp"
#include "io/analysis_file.hpp"
#include "io/durable.hpp"
#include "io/run_record.hpp"
#include "io/sweep_analysis.hpp"
#include "io/sweep_record.hpp"

namespace corpuscle::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

analysis::AnalysisOptions choices_of(const AnalyseOptions& options) {
  analysis::AnalysisOptions choices;
  choices.wall_layer = options.wall_layer;
  choices.mean_flow = options.mean_flow == "uniform" ? analysis::MeanFlow::uniform : analysis::MeanFlow::measured;
  choices.rate = options.shear_rate == "bulk" ? analysis::RateOf::bulk : analysis::RateOf::walls;
  if (options.discard) choices.discard = *options.discard;
  if (options.longest_lag) choices.longest_lag = *options.longest_lag;
  return choices;
}

/// Analyses one run and writes .json and .md. @returns the page
std::string analyse_run(const fs::path& directory, const fs::path& output, const analysis::AnalysisOptions& choices) {
  require_replaceable(output, analysis_format, {".md"});
  const auto [record, analysis] = analysis::analyse_referred(read_run_record(directory), choices);
  const std::string page = analysis_page(record, analysis);
  replace_file(fs::path(output).replace_extension(".md"), page, "the page of the analysis");
  replace_file(output, analysis_json(record, analysis).dump(1) + "\n", "the analysis");
  return page;
}

/// Whether the analysis of a run is there, newer than its data, of this version and with these choices.
bool is_current(const fs::path& run, const analysis::AnalysisOptions& choices) {
  const fs::path results = run / "analysis.json";
  std::error_code error;
  if (!fs::exists(results, error) || fs::last_write_time(results, error) <= fs::last_write_time(run / "run.h5", error) || error) return false;
  try {
    const Json json = read_analysis(results);
    return json.at("version") == version_string() && json.at("git_revision") == git_revision() && json.at("settings").at("asked") == asked_json(choices);
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace

Json analysed(const fs::path& run, const analysis::AnalysisOptions& choices, bool* was_there) {
  const bool current = is_current(run, choices);
  if (!current) analyse_run(run, run / "analysis.json", choices);
  if (was_there != nullptr) *was_there = current;
  return read_analysis(run / "analysis.json");
}

namespace {

int analyse_sweep(const fs::path& directory, const fs::path& output, const SweepRecord& sweep, const analysis::AnalysisOptions& choices) {
  require_replaceable(output, sweep_analysis_format, {".md", ".csv", ".h5"});
  std::vector<AnalysedRun> runs;
  std::vector<std::string> warnings;
  std::size_t number = 0;
  for (const auto& run : sweep.runs) {
    const fs::path place = directory / run.name;
    ++number;
    std::error_code ignored;
    if (!fs::exists(place / "run.h5", ignored)) {
      warnings.push_back(fmt::format("{}: {}, there is no run.h5 yet", run.name, name_of(run.state)));
      continue;
    }
    try {
      bool current = false;
      runs.push_back({run.name, analysed(place, choices, &current)});
      fmt::print("{} of {}: {} {}\n", number, sweep.runs.size(), run.name, current ? "was analysed before" : "analysed");
      std::fflush(stdout);
      runs.back().analysis.erase("curves");  // thousands of runs have megabytes of them
      runs.back().fits = run.state != RunState::failed;
      if (run.state == RunState::failed) warnings.push_back(fmt::format("{}: failed ({}): analysed as far as it came, left out of the fits", run.name, run.message));
      else if (run.state != RunState::finished) warnings.push_back(fmt::format("{}: {}, analysed as far as it is", run.name, name_of(run.state)));
    } catch (const InputError& error) {
      warnings.push_back(fmt::format("{}: left out: {}", run.name, error.what()));
    }
  }
  if (runs.empty()) {
    std::string reasons;
    for (const auto& text : warnings) reasons += "; " + text;
    throw InputError(fmt::format("analyse {}: no run of the sweep can be analysed{}", directory.string(), reasons));
  }
  const SweepAnalysis all = combine(std::move(runs), std::move(warnings));
  const std::string page = sweep_analysis_page(all);
  replace_file(fs::path(output).replace_extension(".md"), page, "the page of the analysis");
  replace_file(fs::path(output).replace_extension(".csv"), sweep_analysis_csv(all), "the table of the analysis");
  write_sweep_analysis_h5(fs::path(output).replace_extension(".h5"), all);
  replace_file(output, sweep_analysis_json(all).dump(1) + "\n", "the analysis");
  fmt::print("\n{}\nresults in {}\n", page, output.string());
  return exit_code::success;
}

}  // namespace

int analyse(const AnalyseOptions& options) {
  const fs::path directory = options.directory;
  const fs::path output = options.output.empty() ? directory / "analysis.json" : fs::path(options.output);
  if (output.extension() != ".json") throw InputError(fmt::format("--output {} must end in .json; the page goes beside it, with .md", output.string()));
  const auto choices = choices_of(options);
  if (const auto sweep = read_sweep_record(directory)) return analyse_sweep(directory, output, *sweep, choices);
  const std::string page = analyse_run(directory, output, choices);
  fmt::print("{}\nresults in {}\n", page, output.string());
  return exit_code::success;
}

}  // namespace corpuscle::app
