// Where a run's start-up ends and its steady state begins.
#pragma once
#include <cstddef>
#include <span>
#include <string>

namespace corpuscle::statistics {

struct Equilibration {
  std::size_t first = 0;  ///< first sample of the steady state: discard [0, first)
  bool converged = false; ///< the steady state was reached in the first half of the series
  std::string reason;     ///< why not
};

/// MSER-m: of all truncation points d the one that minimises sum_{i>=d} (y_i - mean_d)^2 / (n-d)^2, the width of the confidence interval of what is
/// left (White, Simulation 69, 323 (1997); batches y of m samples, m = 5 or more, at most 200 batches: White, Cobb & Spratt 2000). A minimum beyond
/// half of the series means that the run is too short, since then the rest doesn't outweigh the start-up: not converged, and `first` is the middle.
/// The last tenth of the batches is no candidate, where the criterion is small by chance. NaN samples are left out of their batches.
Equilibration equilibration(std::span<const double> series);

}  // namespace corpuscle::statistics
