#include "physics/statistics/ellipsoid.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace corpuscle::statistics {

EllipsoidFit fit_ellipsoid(const std::array<double, 6>& gyration) {
  const auto& [xx, yy, zz, xy, xz, yz] = gyration;
  Eigen::Matrix3d moments;
  moments << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments);  // eigenvalues ascend
  const Eigen::Matrix3d& axes = solver.eigenvectors();

  EllipsoidFit fit;
  for (int i = 0; i < 3; ++i) {
    // A solid ellipsoid of semi-axis a has the second moment a^2/5; rounding may leave a flat cell slightly negative.
    fit.semi_axes[static_cast<std::size_t>(i)] = std::sqrt(5 * std::max(solver.eigenvalues()[2 - i], 0.0));
    fit.symmetry_axis[static_cast<std::size_t>(i)] = axes(i, 0);
  }

  // The axis closest to the vorticity direction y is left out; the others span the cell's section in the shear plane.
  int vorticity = 0;
  axes.row(1).cwiseAbs().maxCoeff(&vorticity);
  int longer = vorticity == 2 ? 1 : 2;
  const int shorter = vorticity == 0 ? 1 : 0;
  const double length = fit.semi_axes[static_cast<std::size_t>(2 - longer)];
  const double breadth = fit.semi_axes[static_cast<std::size_t>(2 - shorter)];
  fit.deformation = length + breadth > 0 ? (length - breadth) / (length + breadth) : 0;

  // An axis has no sense of direction: bring the angle into (-pi/2, pi/2].
  double angle = std::atan2(axes(2, longer), axes(0, longer));
  if (angle > std::numbers::pi / 2) angle -= std::numbers::pi;
  if (angle <= -std::numbers::pi / 2) angle += std::numbers::pi;
  fit.inclination = angle;
  return fit;
}

}  // namespace corpuscle::statistics
