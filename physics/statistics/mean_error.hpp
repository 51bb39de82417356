// Mean of a correlated time series with an honest error.
#pragma once
#include <span>

#include "physics/statistics/estimate.hpp"

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

/// The same with the reason when it isn't converged; correlation time in units of `time_step`.
Estimate mean_estimate(std::span<const double> series, double time_step = 1);

/// Mean and error from the scatter of the means of `blocks` equal stretches of the series (Flyvbjerg & Petersen 1989), an estimate that knows nothing
/// of the shape of the correlation. The correlation time, in units of `time_step`, is the one that explains the error. Not converged below 8 blocks or
/// when neighbouring blocks are still correlated.
Estimate block_mean(std::span<const double> series, int blocks = 20, double time_step = 1);

}  // namespace corpuscle::statistics
