// How long a call takes, for calibration and benchmarks.
#pragma once
#include <algorithm>

#include "core/types.hpp"

namespace corpuscle {

/// Seconds of one call of f: after one call that is not counted, the best of `repeats` averages over at least 0.1 s.
template <class F>
double best_seconds(const F& f, int repeats) {
  f();
  double best = 1e30;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    Kokkos::fence();
    Kokkos::Timer timer;
    int calls = 0;
    do {
      f();
      ++calls;
      Kokkos::fence();
    } while (timer.seconds() < 0.1);
    best = std::min(best, timer.seconds() / calls);
  }
  return best;
}

}  // namespace corpuscle
