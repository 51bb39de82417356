// The statistics of a running simulation in the form of an analysis, so that both are written, read and drawn by the same code.
#pragma once
#include <utility>

#include "physics/analysis/record.hpp"
#include "physics/analysis/results.hpp"
#include "physics/live_statistics.hpp"

namespace corpuscle::analysis {

/// Everything that `statistics` has; the reason of all else says that it takes `corpuscle analyse`. The record holds the numbers of the run, no series.
std::pair<RunRecord, Analysis> live_analysis(const LiveStatistics& statistics, const LatticeParameters& lattice);

}  // namespace corpuscle::analysis
