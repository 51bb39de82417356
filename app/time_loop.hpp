// The time loop of run and resume: steps, samples, snapshots, checkpoints, guards, until the end, a signal, the wall time or a failure; then the summary.
#pragma once
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

#include "app/outputs.hpp"
#include "app/stop.hpp"
#include "io/checkpoint.hpp"
#include "io/summary.hpp"
#include "physics/live_statistics.hpp"

namespace corpuscle::app {

/// Writes checkpoints of a run at the cadence of its scene.
class Checkpoints {
 public:
  Checkpoints(const std::filesystem::path& directory, const Problem& problem, const LatticeParameters& lattice);

  /// After a resume: nothing has to be written until something has been computed.
  void go_on_after(const CheckpointFile& file);
  bool due(std::int64_t step) const;
  /// Writes one unless this step has one, after everything measured before it has been flushed. @throws SimulationError when the state is no good one,
  /// OutputError
  void write(Suspension& suspension, Outputs& outputs, const SeriesSummary& series, const std::optional<LiveStatistics>& statistics, std::int64_t step, double seconds);
  /// Even if this step has one: the scene has changed.
  void forget_last() { last_step_ = -1; }
  /// How long the last one took.
  double seconds_to_write() const { return seconds_to_write_; }

 private:
  using Clock = std::chrono::steady_clock;
  CheckpointStore store_;
  Checkpoint contents_;  ///< what is the same each time
  std::chrono::duration<double> every_;
  std::int64_t every_steps_, every_strain_;  ///< both in time steps; 0: none
  Clock::time_point last_ = Clock::now();
  std::int64_t last_step_ = -1;
  double seconds_to_write_ = 0;
};

/// What the scene asks for beside series and trajectories; nothing without output.statistics.
std::optional<LiveStatistics> live_statistics(const Problem& problem, const LatticeParameters& lattice);

/// A run that is ready to go on, at a step that the suspension is at.
struct ReadyRun {
  const std::filesystem::path& directory;
  const Problem& problem;
  const LatticeParameters& lattice;
  Suspension& suspension;
  Outputs& outputs;
  SeriesSummary& series;
  std::optional<LiveStatistics>& statistics;
  Checkpoints& checkpoints;
  std::int64_t first_step = 0;
  double earlier_seconds = 0;  ///< time of the steps before
  WallTime wall_time{0};
  bool profile = false;
};

/// Goes on to the end and writes the summary. @returns the exit code
int run_to_end(const ReadyRun& run);

}  // namespace corpuscle::app
