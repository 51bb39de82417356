// The analyses of a sweep's runs put together: analysis.json, .csv, .h5 and .md in the directory of the sweep (docs/analysis.md).
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "physics/analysis/flow_curves.hpp"

namespace corpuscle {

inline constexpr const char* sweep_analysis_format = "corpuscle-sweep-analysis-1";

/// One run with what its analysis.json says.
struct AnalysedRun {
  std::string directory;  ///< relative to that of the sweep
  nlohmann::ordered_json analysis;
  bool fits = true;  ///< it takes part in the fits over all runs; one that failed doesn't
};

struct SweepAnalysis {
  std::vector<AnalysedRun> runs;
  std::vector<analysis::FlowCurve> curves;
  statistics::Estimate critical_volume_fraction;
  statistics::Fit gap_radius;
  std::vector<std::string> warnings;
};

/// Reads an analysis.json. @throws InputError when it isn't one.
nlohmann::ordered_json read_analysis(const std::filesystem::path& path);

/// One estimate of an analysis.json. @throws nlohmann::json::exception when it has none of that name
statistics::Estimate estimate_of(const nlohmann::ordered_json& analysis, const std::string& name);

/// Fits over all runs.
SweepAnalysis combine(std::vector<AnalysedRun> runs, std::vector<std::string> warnings);

nlohmann::ordered_json sweep_analysis_json(const SweepAnalysis& sweep);
/// One line a run: what it is, then value, error and whether it has converged of every number. Empty where there is none.
std::string sweep_analysis_csv(const SweepAnalysis& sweep);
std::string sweep_analysis_page(const SweepAnalysis& sweep);
/// The same as the .csv, as arrays [runs]; NaN where there is nothing. @throws OutputError
void write_sweep_analysis_h5(const std::filesystem::path& path, const SweepAnalysis& sweep);

}  // namespace corpuscle
