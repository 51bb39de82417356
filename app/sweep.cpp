// corpuscle sweep: a matrix of scenes, planned as a whole, run side by side, taken up again where it was stopped.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>

#include "app/commands.hpp"
#include "app/job_array.hpp"
#include "app/machine.hpp"
#include "app/output_directory.hpp"
#include "app/sweep_directory.hpp"
#include "app/sweep_execute.hpp"
#include "app/sweep_points.hpp"
#include "app/sweep_plan.hpp"
#include "app/sweep_schedule.hpp"
#include "core/error.hpp"
#include "core/types.hpp"
#include "io/lock.hpp"
#include "io/progress.hpp"

namespace corpuscle::app {
namespace {

namespace fs = std::filesystem;

SweepMachine this_machine() {
  const double bytes = double(available_memory_bytes());
  return {int(std::max<std::int64_t>(1, cpu_cores())), bytes > 0 ? 0.9 * bytes : std::numeric_limits<double>::infinity(), runs_on_host};
}

/// @throws InputError that lists the points which don't fit into the memory even alone
void require_memory(const std::vector<PlannedPoint>& points) {
  const double total = double(total_memory_bytes());
  if (!runs_on_host || !(total > 0)) return;
  std::string problems;
  for (const PlannedPoint& p : points)
    if (p.bytes > total) problems += fmt::format("\n  {}: {:.1f} GiB", p.point.name, p.bytes / (1 << 30));
  if (!problems.empty())
    throw InputError(fmt::format("Points of the sweep need more memory than the {:.1f} GiB that this machine has, so nothing was started: reduce box.size or accuracy.radius, or "
                                 "run them elsewhere with --job-array:{}", total / (1 << 30), problems));
}

/// What isn't through, with its share of the machine. `measure`: how long it takes, too.
SweepWork work_of(const SweepDirectory& directory, const std::vector<PlannedPoint>& points, const SweepMachine& machine, const SweepLimits& limits) {
  std::vector<std::size_t> left;
  std::vector<RunSize> sizes;
  std::vector<const PlannedPoint*> planned;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SweepRun& run = directory.record().runs[directory.run_of(i)];
    if (run.state == RunState::finished || (run.state == RunState::failed && run.exit_code == exit_code::broken_run)) continue;
    left.push_back(i);
    planned.push_back(&points[i]);
    sizes.push_back({points[i].lattice.box_volume(), points[i].bytes, 0});
  }
  const auto threads = threads_of_runs(sizes, machine, limits);
  const auto per_step = seconds_per_step(planned, threads);
  for (std::size_t i = 0; i < left.size(); ++i) {
    const std::int64_t done = look_at_run(directory.run(planned[i]->point.name)).steps;
    sizes[i].seconds = per_step[i] * double(std::max<std::int64_t>(0, planned[i]->lattice.steps - done));
  }
  return {left, sizes, SweepSlots(sizes, threads, machine, limits)};
}

std::string time_text(double seconds) { return std::isfinite(seconds) ? format_duration(seconds) : "unknown"; }

std::string memory_text(double bytes) { return bytes < (1 << 30) ? fmt::format("{:.0f} MiB", bytes / (1 << 20)) : fmt::format("{:.1f} GiB", bytes / (1 << 30)); }

void print_table(const SweepDirectory& directory, const std::vector<PlannedPoint>& points, const SweepWork& work) {
  std::size_t width = 5;
  for (const PlannedPoint& p : points) width = std::max(width, p.point.name.size());
  fmt::print("{:<{}}  {:>7}  {:>12}  {:>11}  {:>9}  {:>7}  {:>14}  state\n", "point", width, "cells", "nodes", "steps", "memory", "threads", "time left");
  double updates = 0, seconds = 0, core_seconds = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const PlannedPoint& p = points[i];
    const SweepRun& run = directory.record().runs[directory.run_of(i)];
    const auto at = std::find(work.points.begin(), work.points.end(), i) - work.points.begin();
    std::string threads = "-", time = "-";
    if (at < std::ssize(work.points)) {
      const int count = work.slots.threads(std::size_t(at));
      threads = std::to_string(count);
      time = time_text(work.sizes[std::size_t(at)].seconds);
      seconds += work.sizes[std::size_t(at)].seconds;
      core_seconds += count * work.sizes[std::size_t(at)].seconds;
    }
    updates += p.lattice.box_volume() * double(p.lattice.steps);
    fmt::print("{:<{}}  {:>7}  {:>12.0f}  {:>11}  {:>9}  {:>7}  {:>14}  {}\n", p.point.name, width, p.cells, p.lattice.box_volume(), p.lattice.steps, memory_text(p.bytes), threads,
               time, name_of(run.state));
  }
  fmt::print("\n{} points, {:.4g} node updates in all; {} left: {} one after the other, {:.1f} core hours", points.size(), updates, work.points.size(), time_text(seconds),
             core_seconds / 3600);
  if (!work.points.empty()) fmt::print("; {} on this machine, {} at a time", time_text(work.slots.seconds()), work.slots.at_once());
  fmt::print(".\nTimes are predicted for this machine, without packing, snapshots and what runs cost each other.\n");
}

void print_left_over(const SweepDirectory& directory) {
  const auto names = directory.left_over();
  if (!names.empty())
    std::cout << fmt::format("{} run{} in {} {} no point of this sweep ({}{}): left as they are\n", names.size(), names.size() == 1 ? "" : "s", directory.path().string(),
                             names.size() == 1 ? "is" : "are", names.front(), names.size() > 1 ? " ..." : "");
}

int make_job_array(const SweepDirectory& directory, const std::vector<PlannedPoint>& points, const SweepOptions& options) {
  std::vector<std::size_t> runs;
  JobArrayOptions job;
  job.wall_time = options.wall_time;
  job.on_device = !runs_on_host;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SweepRun& run = directory.record().runs[directory.run_of(i)];
    if (run.state == RunState::finished || run.state == RunState::running || (run.state == RunState::failed && run.exit_code == exit_code::broken_run)) continue;
    runs.push_back(directory.run_of(i));
    job.bytes = std::max(job.bytes, points[i].bytes);
    // On a cluster's node others have the cores that a task leaves.
    job.threads = std::max(job.threads, options.threads > 0 ? options.threads : int(std::clamp(points[i].lattice.box_volume() / nodes_per_thread, 1.0, 64.0)));
  }
  if (runs.empty()) {
    std::cout << "nothing is left to be done: no job array was written\n";
    return exit_code::success;
  }
  std::sort(runs.begin(), runs.end());
  write_job_array(directory, runs, job);
  std::cout << fmt::format("{} tasks of {} cores and {}: sbatch {}\n", runs.size(), job.threads, memory_text(job.bytes), (directory.path() / "job_array.sh").string());
  return exit_code::success;
}

}  // namespace

int run_points(const std::string& scene, std::vector<PlannedPoint>& points, const SweepOptions& options) {
  const WallTime wall_time(options.wall_time.empty() ? 0 : parse_wall_time(options.wall_time));
  if (options.job_array && options.jobs > 0) throw InputError("--jobs has no effect with --job-array: Slurm decides how many tasks run at a time (sbatch --array=1-28%4 limits them).");
  print_warnings(warnings_of(points));
  const SweepLimits limits{options.jobs, options.threads};
  if (options.dry_run) {
    const SweepDirectory directory(options.output, scene, points);
    print_table(directory, points, work_of(directory, points, this_machine(), limits));
    print_left_over(directory);
    return exit_code::success;
  }
  if (!options.job_array) require_memory(points);
  require_writable(options.output);
  (void)SweepDirectory(options.output, scene, points);  // refuses what it must before a directory is made
  create_output_directory(options.output);
  const DirectoryLock lock(options.output);
  SweepDirectory directory(options.output, scene, points);
  directory.write();
  print_left_over(directory);
  if (options.job_array) return make_job_array(directory, points, options);

  const SweepWork work = work_of(directory, points, this_machine(), limits);
  if (work.points.empty()) std::cout << fmt::format("all {} points are through\n", points.size());
  else
    std::cout << fmt::format("{} points, {} left: {} at a time, predicted {}\n", points.size(), work.points.size(), work.slots.at_once(), time_text(work.slots.seconds()))
              << std::flush;
  return execute(directory, points, work, wall_time);
}

int sweep(const SweepOptions& options) {
  const Sweep sweep = read_sweep(options.sweep);
  std::vector<PlannedPoint> points = plan_points(sweep);
  return run_points(sweep.scene, points, options);
}

}  // namespace corpuscle::app
