// A Slurm job array that runs the points of a sweep, one task each.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "app/sweep_directory.hpp"

namespace corpuscle::app {

struct JobArrayOptions {
  int threads = 1;          ///< cores of a task
  double bytes = 0;         ///< of memory for a task, the most that any needs
  std::string wall_time;    ///< HH:MM:SS after which a task stops and submits itself again; empty: 11:50:00
  bool on_device = false;   ///< ask for a GPU
};

/// Numbers of the tasks as Slurm wants them, "1-4,7", from those of the runs in ascending order, counted from 0.
std::string task_list(const std::vector<std::size_t>& runs);

/// Writes points.txt, a line for each run in the order of sweep.json (so that the number of a task stays what it is when points are added), and job_array.sh for
/// those of `runs`. @throws OutputError
void write_job_array(const SweepDirectory& directory, const std::vector<std::size_t>& runs, const JobArrayOptions& options);

}  // namespace corpuscle::app
