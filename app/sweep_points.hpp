// The points of a sweep or of a study, run in a directory.
#pragma once
#include "app/commands.hpp"
#include "app/sweep_plan.hpp"

namespace corpuscle::app {

/// Runs what isn't through in `options.output`, or writes a job array, or only prints what would be done. `options.sweep` isn't looked at. @returns the exit code of `corpuscle sweep`
/// @throws InputError, OutputError
int run_points(const std::string& scene, std::vector<PlannedPoint>& points, const SweepOptions& options);

}  // namespace corpuscle::app
