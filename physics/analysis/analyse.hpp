// All observables of one run.
#pragma once
#include "physics/analysis/record.hpp"
#include "physics/analysis/results.hpp"

namespace corpuscle::analysis {

/// Computes what the record allows; what it doesn't is NaN with a reason. Memory: about ten arrays [times][cells].
/// @throws InputError when an option doesn't fit the run, or it has no sample.
Analysis analyse(const RunRecord& record, const AnalysisOptions& options = {});

}  // namespace corpuscle::analysis
