// All observables of one run.
#pragma once
#include <utility>

#include "physics/analysis/record.hpp"
#include "physics/analysis/results.hpp"

namespace corpuscle::analysis {

/// Computes what the record allows; what it doesn't is NaN with a reason. Memory: about ten arrays [times][cells].
/// @throws InputError when an option doesn't fit the run, or it has no sample.
Analysis analyse(const RunRecord& record, const AnalysisOptions& options = {});

/// The same with the rate that the options ask for as the unit: with that of the bulk the run is analysed twice, first to measure it. The record of the results is the run as it is
/// referred to that rate; where the bulk's rate isn't known it is that of the walls, and a warning says so.
std::pair<RunRecord, Analysis> analyse_referred(RunRecord record, const AnalysisOptions& options);

}  // namespace corpuscle::analysis
