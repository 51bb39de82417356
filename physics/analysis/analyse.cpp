#include "physics/analysis/analyse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "physics/analysis/groups.hpp"

namespace corpuscle::analysis {
namespace {

statistics::Estimate largest(const std::vector<double>& series) {
  statistics::Estimate result;
  for (const double value : series) {
    if (std::isnan(value)) continue;
    result.value = std::fmax(result.value, value);
    result.effective_samples += 1;
  }
  result.converged = result.effective_samples > 0;
  if (!result.converged) result.reason = "the series has no valid sample";
  return result;
}

}  // namespace

Analysis analyse(const RunRecord& record, const AnalysisOptions& options) {
  Analysis analysis;
  analysis.warnings = record.warnings;
  const SteadyState state(record, options, analysis);
  add_rheology(state, analysis);
  add_structure(state, analysis);
  add_velocities(state, analysis);
  add_gap(state, analysis);
  add_diffusion(state, analysis);
  add_stresslets(state, analysis);
  add_shapes(state, analysis);
  if (!analysis.start_up.converged) {
    const std::string reason = "start-up: " + analysis.start_up.reason;
    analysis.doubt_averages(reason);
    analysis.warnings.push_back(reason);
  }
  analysis.estimate("area_drift_max") = largest(record.area_drift_max);
  analysis.estimate("volume_drift_max") = largest(record.volume_drift_max);
  if (record.cell_count() == 0) analysis.refuse(Group::drift, "there are no cells");
  if (std::count_if(record.types.begin(), record.types.end(), [](const auto& type) { return type.count > 0; }) > 1) {
    analysis.warnings.push_back(fmt::format("{} types of cells: means and distributions are over the cells of all types together", record.types.size()));
  }
  return analysis;
}

}  // namespace corpuscle::analysis
