// The period of tumbling cells.
#pragma once
#include "physics/statistics/orientation.hpp"

namespace corpuscle::statistics {

/// Time in which an axis turns once in the shear plane: twice the mean time between passages of its projection through the gradient direction (+z and -z are the same for an axis). A
/// cell rests longest there, so a cell that swings to and fro is no tumbler: passages count where the projection goes on in the direction in which it has turned on the whole.
/// Interpolated between samples; cells with fewer than two passages don't count, nor do gaps. The error is from the scatter of the times between passages, over all cells; with fewer than
/// three of them there is none, and the period isn't converged.
Estimate tumbling_period(const AxisSeries& axes, double time_step);

}  // namespace corpuscle::statistics
