// Self-diffusion coefficient of one component, three ways.
#pragma once
#include "physics/statistics/fit.hpp"
#include "physics/statistics/resample.hpp"

namespace corpuscle::statistics {

/// Half the slope of a straight line through the MSD in [from, to], in units of x^2/t: D = lim MSD/(2 t), and the line's intercept takes up the
/// ballistic start (MSD = 2 D (t - tau) for an exponential velocity correlation). `to` 0: the last lag that errors can be trusted at; `from` 0: half
/// of `to`. Not converged where the slopes of the window's two halves differ by more than 2 standard errors and 5 %: the MSD isn't linear there yet.
Estimate diffusion_from_msd(const BlockedCurve& msd, double from = 0, double to = 0, const Resampling& resampling = {});

/// Green-Kubo: integral of the velocity autocorrelation from 0 to `to` by the trapezoidal rule (Kubo 1957; Allen & Tildesley 1987, ch. 2.7). `to` 0: the
/// first lag t >= 6 I(t)/C(0), I being the integral up to t, which cuts 0.25 % off an exponential. Correlation time: D/C(0), in units of the lag. Not
/// converged where no such lag exists or the samples lie too far apart (C(dt) < 0.6 C(0): the rule's error would be above 2 %).
Estimate diffusion_from_vacf(const BlockedCurve& vacf, double to = 0, const Resampling& resampling = {});

/// Integral relaxation time of a correlation, int C dt/C(0), with the same window and the same doubts; in units of the lag. For the stress of the whole
/// suspension, one series, `autocorrelation_time` corrects for the subtracted mean besides.
Estimate relaxation_time(const BlockedCurve& correlation, double to = 0, const Resampling& resampling = {});

/// From C(t) = C0 exp[-(t/tau)^b] fitted for t <= `to`: D = C0 tau Gamma(1 + 1/b), its integral. The fit comes along; correlation time: D/C0.
struct StretchedDiffusion {
  Estimate diffusion;
  Fit fit;
};
StretchedDiffusion diffusion_from_stretched_exponential(const BlockedCurve& vacf, double to, const Resampling& resampling = {});

}  // namespace corpuscle::statistics
