// How the runs of a sweep share a machine (docs/sweep.md, "Cores and memory"). Pure functions: nothing is measured or started here.
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

namespace corpuscle::app {

/// What a run will need.
struct RunSize {
  double nodes = 0;
  double bytes = 0;    ///< at most
  double seconds = 0;  ///< predicted time that is left, with its threads; NaN: unknown
};

struct SweepMachine {
  int cores = 1;
  double bytes = 0;      ///< of memory for all runs together
  bool on_host = true;   ///< false: runs compute on a device, which one of them fills
};

/// From the command line; 0: chosen here.
struct SweepLimits {
  int jobs = 0;
  int threads = 0;
};

/// A thread that has fewer nodes loses more than a tenth of its time to launching kernels and to waiting for the others.
inline constexpr double nodes_per_thread = 50'000;
/// Cores that would be idle otherwise are used down to this.
inline constexpr double fewest_nodes_per_thread = 10'000;

/// Threads of each run. One for each `nodes_per_thread` nodes, so that small runs stand side by side; more where fewer runs than cores are left.
std::vector<int> threads_of_runs(const std::vector<RunSize>& runs, const SweepMachine& machine, const SweepLimits& limits);

/// Numbers of the runs in the order in which they begin: the longest first, so that all cores have work until the end.
std::vector<std::size_t> longest_first(const std::vector<RunSize>& runs);

/// Which runs may go on beside each other.
class SweepSlots {
 public:
  SweepSlots(const std::vector<RunSize>& runs, std::vector<int> threads, const SweepMachine& machine, const SweepLimits& limits);
  /// The first of `waiting` that fits beside those that are running: jobs, cores and memory. One alone always fits.
  std::optional<std::size_t> next(const std::vector<std::size_t>& waiting, const std::vector<std::size_t>& running) const;
  int threads(std::size_t run) const { return threads_[run]; }
  /// How many begin together.
  std::size_t at_once() const;
  /// Until all are through, when each takes as long as predicted.
  double seconds() const;

 private:
  std::vector<RunSize> runs_;
  std::vector<int> threads_;
  int jobs_, cores_;
  double bytes_;
};

}  // namespace corpuscle::app
