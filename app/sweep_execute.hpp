// Runs the points of a sweep until all are through, or it is stopped.
#pragma once
#include "app/stop.hpp"
#include "app/sweep_directory.hpp"
#include "app/sweep_schedule.hpp"

namespace corpuscle::app {

/// What is to be done in a sweep.
struct SweepWork {
  std::vector<std::size_t> points;  ///< numbers of those that aren't through
  std::vector<RunSize> sizes;       ///< of each of them
  SweepSlots slots;
};

/// Starts, watches and records the runs. @returns the exit code: 0 all finished, 1 some failed, 75 or 130 stopped. @throws OutputError when sweep.json can't be written
int execute(SweepDirectory& directory, const std::vector<PlannedPoint>& points, const SweepWork& work, const WallTime& wall_time);

}  // namespace corpuscle::app
