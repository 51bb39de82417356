// Moments of triangulated bodies and the ellipsoid fitted to them, against bodies of known axes and angles.
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "physics/mesh.hpp"
#include "physics/statistics/ellipsoid.hpp"
#include "physics/statistics/volume_moments.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;
using statistics::fit_ellipsoid;
using statistics::volume_moments;

namespace {

/// Gyration of a solid ellipsoid: R diag(a^2)/5 R^T.
std::array<double, 6> gyration_of(const Eigen::Vector3d& semi_axes, const Eigen::Matrix3d& rotation) {
  const Eigen::Matrix3d m = rotation * semi_axes.cwiseAbs2().asDiagonal() * rotation.transpose() / 5;
  return {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2)};
}

/// Turns x towards z by `angle`, in the shear plane.
Eigen::Matrix3d in_shear_plane(double angle) { return Eigen::AngleAxisd(-angle, Eigen::Vector3d::UnitY()).toRotationMatrix(); }

}  // namespace

TEST_CASE("fit_ellipsoid: axes, deformation and inclination of a tilted ellipsoid", "[statistics]") {
  const double pi = std::numbers::pi;
  for (const double angle : {0.0, 0.3, pi / 4, 1.5, -0.7, -1.5}) {
    const auto fit = fit_ellipsoid(gyration_of({5, 3, 2}, in_shear_plane(angle)));
    CAPTURE(angle);
    CHECK(fit.semi_axes[0] == Approx(5));
    CHECK(fit.semi_axes[1] == Approx(3));
    CHECK(fit.semi_axes[2] == Approx(2));
    CHECK(fit.deformation == Approx(3.0 / 7));  // of 5 and 2: the axis along y is left out
    CHECK(fit.inclination == Approx(angle).margin(1e-9));
    CHECK(std::abs(fit.symmetry_axis[0]) == Approx(std::abs(std::sin(angle))).margin(1e-9));
    CHECK(fit.symmetry_axis[1] == Approx(0).margin(1e-9));
  }
  CHECK(fit_ellipsoid(gyration_of({5, 3, 2}, in_shear_plane(pi / 2))).inclination == Approx(pi / 2));
  CHECK(fit_ellipsoid(gyration_of({2, 5, 3}, in_shear_plane(0.2))).deformation == Approx(1.0 / 5));  // the longest axis is the vorticity's
}

TEST_CASE("fit_ellipsoid: D is the section's and continuous when the cell turns out of the shear plane", "[statistics]") {
  // Semi-axes 4 (turned by t from x towards y), 1 along z, 2: the section's length is (cos^2/16 + sin^2/4)^-1/2.
  double previous = 3.0 / 5;
  for (double t = 0; t < 3.2; t += 0.01) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(t, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const double length = 1 / std::sqrt(std::pow(std::cos(t) / 4, 2) + std::pow(std::sin(t) / 2, 2));
    const double deformation = fit_ellipsoid(gyration_of({4, 2, 1}, turn)).deformation;
    CHECK(deformation == Approx((length - 1) / (length + 1)));
    CHECK(std::abs(deformation - previous) < 0.01);
    previous = deformation;
  }
}

TEST_CASE("fit_ellipsoid: degenerate bodies", "[statistics]") {
  CHECK(fit_ellipsoid(gyration_of({4, 4, 4}, in_shear_plane(0.4))).deformation == Approx(0).margin(1e-12));
  // A disc whose normal is tilted in the shear plane: D of its diameter and its thickness, its inclination along the diameter.
  const auto disc = fit_ellipsoid(gyration_of({4, 4, 1}, in_shear_plane(0.5)));
  CHECK(disc.deformation == Approx(3.0 / 5));
  CHECK(disc.inclination == Approx(0.5).margin(1e-6));
  // Rounding may leave a flat body with a moment slightly below zero.
  const auto flat = fit_ellipsoid({1, 1, -1e-18, 0, 0, 0});
  CHECK(flat.semi_axes[2] == 0);
  CHECK(flat.deformation == 1);
  CHECK(fit_ellipsoid({}).deformation == 0);
}

TEST_CASE("volume_moments: box, ellipsoid and distance from the origin", "[statistics]") {
  Mesh box;
  for (int i = 0; i < 8; ++i) box.vertices.emplace_back(2.0 * (i & 1), 3.0 * (i >> 1 & 1), 4.0 * (i >> 2));
  box.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  for (const double shift : {0.0, 1e6}) {
    std::vector<double> positions;
    for (const auto& vertex : box.vertices) positions.insert(positions.end(), {vertex.x() + shift, vertex.y(), vertex.z() - shift});
    const auto moments = volume_moments(positions, box.faces);
    CHECK(moments.volume == Approx(24));
    CHECK(moments.centre[0] - shift == Approx(1).epsilon(1e-9));
    CHECK(moments.centre[1] == Approx(1.5));
    CHECK(moments.centre[2] + shift == Approx(2).epsilon(1e-9));
    CHECK(moments.gyration[0] == Approx(4.0 / 12));
    CHECK(moments.gyration[1] == Approx(9.0 / 12));
    CHECK(moments.gyration[2] == Approx(16.0 / 12));
    for (std::size_t i = 3; i < 6; ++i) CHECK(moments.gyration[i] == Approx(0).margin(1e-9));
  }
}

TEST_CASE("volume_moments and fit_ellipsoid: a deformed icosphere", "[statistics]") {
  const Mesh sphere = icosphere(24);
  const Eigen::Matrix3d rotation = in_shear_plane(0.4);
  std::vector<double> positions;
  for (const auto& vertex : sphere.vertices) {
    const Eigen::Vector3d x = rotation * Eigen::Vector3d(6 * vertex.x(), 4 * vertex.y(), 3 * vertex.z());
    positions.insert(positions.end(), {x.x(), x.y(), x.z()});
  }
  const auto fit = fit_ellipsoid(volume_moments(positions, sphere.faces).gyration);
  CHECK(fit.semi_axes[0] == Approx(6).epsilon(0.005));
  CHECK(fit.semi_axes[1] == Approx(4).epsilon(0.005));
  CHECK(fit.semi_axes[2] == Approx(3).epsilon(0.005));
  CHECK(fit.deformation == Approx(1.0 / 3).epsilon(0.001));
  CHECK(fit.inclination == Approx(0.4).epsilon(0.001));
}
