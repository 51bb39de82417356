// Probability densities and moments of correlated samples, with errors.
#pragma once
#include "physics/statistics/estimate.hpp"
#include "physics/statistics/fit.hpp"
#include "physics/statistics/resample.hpp"

namespace corpuscle::statistics {

/// Counts per bin and stretch of time. Bins have equal widths.
struct Histogram {
  Eigen::VectorXd edges;           ///< bins + 1, ascending
  Eigen::MatrixXd counts;          ///< [bins][blocks]
  Eigen::VectorXd samples;         ///< [blocks], all valid ones, also those outside of the edges
  std::string reason;              ///< why there is nothing

  Eigen::VectorXd centres() const { return 0.5 * (edges.head(edges.size() - 1) + edges.tail(edges.size() - 1)); }
  double width() const { return edges[1] - edges[0]; }
};

/// Values [times][particles] into bins from `from` to `to`; stretches of time are the independent blocks. `blocks` 0: as many stretches of ten correlation
/// times as there are, 10 to 32. The correlation time is that of the mean over particles of (x - mean)^2.
Histogram histogram(const SeriesMatrix& values, double from, double to, Eigen::Index bins, Eigen::Index blocks = 0);

/// The same over the mean +- `reach` standard deviations.
Histogram histogram_around_mean(const SeriesMatrix& values, double reach = 6, Eigen::Index bins = 60, Eigen::Index blocks = 0);

/// Density p(x), in 1/unit of x, normalised by all samples. Empty bins are 0 with error NaN.
Curve probability_density(const Histogram& histogram, const Resampling& resampling = {});

struct Moments {
  Estimate mean, variance;  ///< variance about the overall mean
  Estimate skewness;        ///< <d^3>/<d^2>^(3/2)
  Estimate excess_kurtosis; ///< <d^4>/<d^2>^2 - 3: 0 for a Gaussian, 3 for exponential tails throughout (Laplace)
};

/// Of all values, errors from stretches of time (`blocks` as above).
Moments moments(const SeriesMatrix& values, Eigen::Index blocks = 0, const Resampling& resampling = {});

/// RMS of the fluctuations over the mean's magnitude, as RMS(sigma)/<sigma>. Not converged where the mean is smaller than twice its error.
Estimate relative_fluctuation(const SeriesMatrix& values, Eigen::Index blocks = 0, const Resampling& resampling = {});

struct CoreAndTails {
  Fit core;                ///< "height", "centre", "width": height exp[-(x-centre)^2/(2 width^2)] where |x - mean| < core_reach standard deviations
  Fit lower, upper;        ///< "height", "decay": height exp(-|x - x0|/decay), x0 = mean -+ tail_start standard deviations, beyond x0
  double lower_start = not_a_number, upper_start = not_a_number;  ///< both x0, on edges of bins
  double gaussian_tail = not_a_number;  ///< samples of the core's Gaussian beyond both tail starts per sample found there: far below 1 for wide tails
};

/// Gaussian core and exponential tails of a density. Counts in bins are Poisson numbers whose likelihood is maximised (Baker & Cousins, Nucl. Instrum.
/// Methods 221, 437 (1984)), so that bins with few or no samples count properly; the model is integrated over each bin. Errors from resampling.
CoreAndTails fit_core_and_tails(const Histogram& histogram, double core_reach = 1, double tail_start = 2, const Resampling& resampling = {});

}  // namespace corpuscle::statistics
