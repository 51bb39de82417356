// Alignment and rotation of cells from series of an axis (EllipsoidFit::symmetry_axis: the disc's normal) or of an angle.
#pragma once
#include <Eigen/Core>

#include "physics/statistics/estimate.hpp"

namespace corpuscle::statistics {

/// Components [times][cells] of a unit vector whose sign has no meaning; x flow, y vorticity, z gradient.
struct AxisSeries {
  SeriesMatrix x, y, z;
};

struct Orientation {
  Eigen::Matrix3d tensor, tensor_error;  ///< <n n>, trace 1, a third each when isotropic
  Eigen::Vector3d director;              ///< eigenvector of the largest eigenvalue, its sign free
  Estimate order;                        ///< largest eigenvalue of (3 <n n> - 1)/2: 1 aligned, 0 isotropic (about 1/sqrt(samples) for a finite sample)
};

/// Orientation tensor and nematic order (de Gennes & Prost 1993, ch. 2). Errors from stretches of time, `blocks` of them.
Orientation orientation(const AxisSeries& axes, Eigen::Index blocks = 16, const Resampling& resampling = {});

struct AxialMean {
  Estimate angle;      ///< in (-pi/2, pi/2]
  Estimate resultant;  ///< R = |<exp(2 i theta)>|: 1 all equal, 0 no preferred direction
};

/// Mean of angles that are the same modulo pi, as inclinations: half the argument of <exp(2 i theta)> (Mardia & Jupp 2000, ch. 1.4). [times][cells], rad.
AxialMean axial_mean(const SeriesMatrix& angles, Eigen::Index blocks = 16, const Resampling& resampling = {});

struct MotionShares {
  Estimate tumbling;        ///< share of cells and windows in which the axis' projection on the shear plane turns by half a turn or more
  Estimate steady;          ///< in which it doesn't: tank-treading, swinging
  Estimate rolling;         ///< in which the axis stays near the vorticity (mean n_y^2 > 3/4, within 30 degrees), so that its projection has no meaning
  Estimate half_turns;      ///< per unit time of a tumbling cell
};

/// Motions, window by window. A window should be longer than half a period of tumbling: for rigid spheroids of aspect p that is pi (p + 1/p)/shear rate
/// (Jeffery 1922), 10.7 strains for a red cell. `window` 0: the whole series. Blocks: windows when there are 8 or more, else groups of cells. Not converged
/// when the projection turns by more than 45 degrees between samples more often than once in a hundred: its turns cannot be followed.
MotionShares motion_shares(const AxisSeries& axes, double time_step, double window = 0, const Resampling& resampling = {});

}  // namespace corpuscle::statistics
