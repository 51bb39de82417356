#include "app/sweep_schedule.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

namespace corpuscle::app {

std::vector<int> threads_of_runs(const std::vector<RunSize>& runs, const SweepMachine& machine, const SweepLimits& limits) {
  std::vector<int> threads;
  const auto side_by_side = limits.jobs > 0 ? limits.jobs : static_cast<int>(std::min<std::size_t>(runs.size(), 1'000'000));
  for (const RunSize& run : runs) {
    const auto at_least = [&](double nodes) { return std::clamp(static_cast<int>(std::min(run.nodes / nodes, 1e6)), 1, machine.cores); };
    const int useful = at_least(fewest_nodes_per_thread);
    if (limits.threads > 0) threads.push_back(limits.threads);
    else if (limits.jobs > 0) threads.push_back(std::clamp(machine.cores / limits.jobs, 1, useful));
    else if (!machine.on_host) threads.push_back(machine.cores);
    else threads.push_back(std::clamp(machine.cores / std::max(1, side_by_side), at_least(nodes_per_thread), useful));
  }
  return threads;
}

std::vector<std::size_t> longest_first(const std::vector<RunSize>& runs) {
  std::vector<std::size_t> order(runs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto length = [&](std::size_t run) { return std::isnan(runs[run].seconds) ? std::numeric_limits<double>::infinity() : runs[run].seconds; };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return length(a) > length(b); });
  return order;
}

SweepSlots::SweepSlots(const std::vector<RunSize>& runs, std::vector<int> threads, const SweepMachine& machine, const SweepLimits& limits)
    : runs_(runs), threads_(std::move(threads)), jobs_(limits.jobs > 0 ? limits.jobs : machine.on_host ? machine.cores : 1), cores_(machine.cores), bytes_(machine.bytes) {
  // Who asks for more threads than there are cores gets them.
  if (limits.jobs > 0) cores_ = std::numeric_limits<int>::max();
  else if (limits.threads > 0) jobs_ = std::max(1, std::min(jobs_, machine.cores / limits.threads));
  if (!machine.on_host) bytes_ = std::numeric_limits<double>::infinity();  // the host's memory tells nothing
}

std::optional<std::size_t> SweepSlots::next(const std::vector<std::size_t>& waiting, const std::vector<std::size_t>& running) const {
  if (running.empty()) return waiting.empty() ? std::nullopt : std::optional(waiting.front());
  if (running.size() >= static_cast<std::size_t>(jobs_)) return {};
  std::int64_t threads = 0;
  double bytes = 0;
  for (const std::size_t run : running) {
    threads += threads_[run];
    bytes += runs_[run].bytes;
  }
  for (const std::size_t run : waiting)
    if (threads + threads_[run] <= cores_ && bytes + runs_[run].bytes <= bytes_) return run;
  return {};
}

std::size_t SweepSlots::at_once() const {
  std::vector<std::size_t> waiting = longest_first(runs_), running;
  while (const auto run = next(waiting, running)) {
    std::erase(waiting, *run);
    running.push_back(*run);
  }
  return running.size();
}

double SweepSlots::seconds() const {
  std::vector<std::size_t> waiting = longest_first(runs_), running;
  std::vector<double> end(runs_.size());
  double now = 0;
  while (!waiting.empty() || !running.empty()) {
    if (const auto run = next(waiting, running)) {
      std::erase(waiting, *run);
      running.push_back(*run);
      end[*run] = now + runs_[*run].seconds;
      continue;
    }
    const auto first = std::min_element(running.begin(), running.end(), [&](std::size_t a, std::size_t b) { return end[a] < end[b]; });
    now = end[*first];
    running.erase(first);
  }
  return now;
}

}  // namespace corpuscle::app
