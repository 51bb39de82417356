// Timing of operators against each other.
#pragma once
#include <algorithm>
#include <functional>
#include <vector>

#include "core/types.hpp"
#include "perf/report.hpp"

namespace corpuscle::perf {

/// Seconds of one call of each operation: the best of `repeats`. They take turns, so that what slows the machine for a while slows all of them, and their
/// ratios hold.
inline std::vector<double> interleaved_seconds(const std::vector<std::function<void()>>& operations, const Effort& effort) {
  for (const auto& operation : operations) operation();  // first touch, allocation
  std::vector<double> best(operations.size(), 1e30);
  for (int repeat = 0; repeat < effort.repeats; ++repeat)
    for (std::size_t i = 0; i < operations.size(); ++i) {
      Kokkos::fence();
      const Kokkos::Timer timer;
      int calls = 0;
      do {
        operations[i]();
        ++calls;
        Kokkos::fence();
      } while (timer.seconds() < effort.min_seconds);
      best[i] = std::min(best[i], timer.seconds() / calls);
    }
  return best;
}

inline double best_of(const std::function<void()>& operation, const Effort& effort) { return interleaved_seconds({operation}, effort)[0]; }

}  // namespace corpuscle::perf
