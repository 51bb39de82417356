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

std::pair<RunRecord, Analysis> analyse_referred(RunRecord record, const AnalysisOptions& options) {
  std::string warning;
  if (options.rate == RateOf::bulk) {
    const statistics::Estimate rate = analyse(record, options).estimate("shear_rate_bulk");
    if (rate.value > 0) {
      if (!rate.converged) warning = fmt::format("the shear rate of the bulk, {:.3g} of that of the walls, isn't converged: {}", rate.value, rate.reason);
      record = referred_to(rate.value, std::move(record));
    } else {
      warning = "referred to the shear rate of the walls, as that of the bulk isn't known: " + (rate.reason.empty() ? fmt::format("it came out as {:.3g} of that of the walls", rate.value) : rate.reason);
    }
  }
  Analysis analysis = analyse(record, options);
  if (!warning.empty()) analysis.warnings.push_back(warning);
  return {std::move(record), std::move(analysis)};
}

}  // namespace corpuscle::analysis
