// Mean of a correlated time series with an honest error.
#pragma once
#include <span>

namespace corpuscle::statistics {

struct MeanError {
  double mean = 0;
  double error = 0;             ///< standard error of the mean, including correlations; NaN with fewer than 2 samples
  double correlation_time = 0;  ///< integrated autocorrelation time in samples (0.5 for white noise)
  double effective_samples = 0;
  bool converged = false;       ///< the series is long enough to trust the error (>= 20 correlation times)
};

/// Mean and error by the integrated autocorrelation time with Sokal's automatic window (c = 5), NaN samples ignored.
MeanError mean_error(std::span<const double> series);

}  // namespace corpuscle::statistics
