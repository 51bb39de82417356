// Integrated autocorrelation time of a series: how many samples make one independent one.
#pragma once
#include <span>

namespace corpuscle::statistics {

/// Autocovariance sums of a series up to Sokal's window.
struct AutocorrelationTime {
  double time = 0;            ///< tau = 1/2 + sum_t rho(t), in samples: 0.5 for white noise; NaN with fewer than 2 valid samples
  double error = 0;           ///< statistical error of tau, sqrt(4(W + 1/2 - tau)/n) tau (Wolff 2004, eq. 42)
  double mean = 0;            ///< of the valid samples
  double variance = 0;        ///< of single samples, unbiased to first order in tau/n
  double mean_variance = 0;   ///< of the mean: 2 tau variance/n without gaps
  double valid_samples = 0;
  int window = 0;             ///< W, the largest lag summed
  bool window_closed = false; ///< W >= 5 tau(W) was reached before the lags ran out (n/2)
  bool constant = false;      ///< all samples equal to within rounding
};

/// Sokal's automatic window (Sokal 1997, "Monte Carlo methods in statistical mechanics"): the smallest W >= 5 tau(W). Deviations from the sample
/// mean lower each autocovariance by 2 tau variance/n; that is added back (Wolff, Comput. Phys. Commun. 156, 143 (2004)). NaN samples are
/// gaps: a lag's covariance is the mean over the pairs of which both samples exist.
AutocorrelationTime autocorrelation_time(std::span<const double> series);

}  // namespace corpuscle::statistics
