// Deformation of a cell from the second moments of its volume.
#pragma once
#include <array>

namespace corpuscle::statistics {

/// Ellipsoid of equal second moments (semi-axis = sqrt(5 eigenvalue), Ramanujan & Pozrikidis 1998).
struct EllipsoidFit {
  std::array<double, 3> semi_axes{};    ///< descending
  double deformation = 0;               ///< D = (L-B)/(L+B) of the ellipsoid's section with the shear plane x-z
  double inclination = 0;               ///< angle of the section's longer axis against +x, rad, in (-pi/2, pi/2]
  std::array<double, 3> symmetry_axis{};///< unit eigenvector of the smallest moment: the disc's normal for red cells
};
/// `gyration`: xx yy zz xy xz yz of CellSample.
EllipsoidFit fit_ellipsoid(const std::array<double, 6>& gyration);

}  // namespace corpuscle::statistics
