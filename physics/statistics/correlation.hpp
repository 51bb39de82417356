// Time correlations and mean square displacements of many particles' series by FFT, O(N log N), with what errors need.
#pragma once
#include "physics/statistics/estimate.hpp"
#include "physics/statistics/resample.hpp"

namespace corpuscle::statistics {

/// What is taken off a series before it is correlated.
enum class MeanRemoval {
  none,      ///< already fluctuations, as velocities minus the local mean flow
  overall,   ///< one mean over all times and particles
  particle,  ///< each particle's own: lowers the correlation by its mean's variance, 2 tau variance/T
};

/// What counts as independent when errors are estimated.
enum class Blocks {
  times,      ///< stretches of time origins: always right when they are longer than the correlations
  particles,  ///< groups of particles: for short runs; particles that move together make it a lower bound
};

struct CorrelationOptions {
  Eigen::Index longest_lag = 0;  ///< in samples; 0: a quarter of the series
  MeanRemoval removal = MeanRemoval::none;
  Blocks blocks_of = Blocks::times;
  Eigen::Index blocks = 16;
};

/// C(t) = <x(s) x(s+t)> over all origins s and all particles of which both samples exist, for t = 0, dt, ... The FFT is zero padded (Wiener & Khinchin;
/// Calandrini et al., Collection SFN 12, 201 (2011)), and spectra are summed before they are transformed back. Unit: that of x squared.
BlockedCurve autocorrelation(const SeriesMatrix& series, double time_step, const CorrelationOptions& options = {});

/// C(t) = <a(s) b(s+t)>, t >= 0; swap a and b for negative t. Same shapes.
BlockedCurve cross_correlation(const SeriesMatrix& a, const SeriesMatrix& b, double time_step, const CorrelationOptions& options = {});

/// MSD(t) = <(x(s+t) - x(s))^2>, one component, positions unwrapped and free of the mean flow; `removal` is ignored. The square is expanded and each
/// particle's positions are taken relative to their mean; the rounding error is about 1e-15 times their mean square.
BlockedCurve mean_square_displacement(const SeriesMatrix& positions, double time_step, const CorrelationOptions& options = {});

/// The same over the origins s where `origins` isn't NaN only: of particles that are in a region at the beginning, wherever they are later. To ask that they
/// are still there would leave the long displacements out.
BlockedCurve mean_square_displacement(const SeriesMatrix& positions, const SeriesMatrix& origins, double time_step, const CorrelationOptions& options);

/// d ln y/d ln x by a straight line through the points within a factor `reach` of each x > 0; NaN where fewer than 3 of them have y > 0.
Eigen::VectorXd local_exponent(const Eigen::VectorXd& x, const Eigen::VectorXd& y, double reach = 1.5);

/// The same with errors by resampling.
Curve local_exponent(const BlockedCurve& curve, double reach = 1.5, const Resampling& resampling = {});

/// C(t)/C(0) with errors, which vanish at t = 0.
Curve normalised(const BlockedCurve& correlation, const Resampling& resampling = {});

/// Fewer points for long curves: about `per_octave` lags in each factor of two, the small ones all.
BlockedCurve thinned(const BlockedCurve& curve, int per_octave = 12);

}  // namespace corpuscle::statistics
