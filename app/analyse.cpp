// corpuscle analyse DIR: all observables of a run, or of all runs of a sweep.
#include "physics/analysis/analyse.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/commands.hpp"
#include "core/error.hpp"
#include "io/analysis_file.hpp"
#include "io/durable.hpp"
#include "io/run_record.hpp"

namespace corpuscle::app {
namespace {

namespace fs = std::filesystem;

analysis::AnalysisOptions choices_of(const AnalyseOptions& options) {
  analysis::AnalysisOptions choices;
  choices.wall_layer = options.wall_layer;
  choices.mean_flow = options.mean_flow == "uniform" ? analysis::MeanFlow::uniform : analysis::MeanFlow::measured;
  if (options.discard) choices.discard = *options.discard;
  if (options.longest_lag) choices.longest_lag = *options.longest_lag;
  return choices;
}

}  // namespace

int analyse(const AnalyseOptions& options) {
  const fs::path directory = options.directory;
  const fs::path output = options.output.empty() ? directory / "analysis.json" : fs::path(options.output);
  if (output.extension() != ".json") throw InputError(fmt::format("--output {} must end in .json; the page goes beside it, with .md", output.string()));
  const analysis::RunRecord record = read_run_record(directory);
  require_replaceable(output, analysis_format);
  const analysis::Analysis analysis = analysis::analyse(record, choices_of(options));
  const std::string page = analysis_page(record, analysis);
  replace_file(output, analysis_json(record, analysis).dump(1) + "\n", "the analysis");
  replace_file(fs::path(output).replace_extension(".md"), page, "the page of the analysis");
  fmt::print("{}\nresults in {}\n", page, output.string());
  return exit_code::success;
}

}  // namespace corpuscle::app
