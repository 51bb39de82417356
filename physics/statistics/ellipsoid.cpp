#include "physics/statistics/ellipsoid.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

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

  // The section with the shear plane is the ellipse of the Schur complement of yy: it changes continuously as the cell turns out of the plane.
  const double inverse = yy > 0 ? 1 / yy : 0;
  Eigen::Matrix2d section;
  section << xx - xy * xy * inverse, xz - xy * yz * inverse, xz - xy * yz * inverse, zz - yz * yz * inverse;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> plane(section);
  const double length = std::sqrt(std::max(plane.eigenvalues()[1], 0.0)), breadth = std::sqrt(std::max(plane.eigenvalues()[0], 0.0));
  fit.deformation = length + breadth > 0 ? (length - breadth) / (length + breadth) : 0;

  // An axis has no sense of direction: bring the angle into (-pi/2, pi/2].
  double angle = std::atan2(plane.eigenvectors()(1, 1), plane.eigenvectors()(0, 1));
  if (angle > std::numbers::pi / 2) angle -= std::numbers::pi;
  if (angle <= -std::numbers::pi / 2) angle += std::numbers::pi;
  fit.inclination = angle;
  return fit;
}

}  // namespace corpuscle::statistics
