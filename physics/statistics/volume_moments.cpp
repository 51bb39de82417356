#include "physics/statistics/volume_moments.hpp"

#include <Eigen/Geometry>

namespace corpuscle::statistics {

// The enclosed space is the signed sum of tetrahedra (o, a, b, c) over the faces. With o as origin and s = a + b + c:
// V = a.(b x c)/6, int x = V s/4, int x x^T = V (a a^T + b b^T + c c^T + s s^T)/20.
VolumeMoments volume_moments(std::span<const double> positions, std::span<const std::array<int, 3>> faces) {
  using Vector = Eigen::Vector3d;
  const auto vertex = [&](int i) { return Eigen::Map<const Vector>(positions.data() + 3 * static_cast<std::size_t>(i)); };
  // A vertex of the cell as origin keeps the digits when the cell has drifted far from the coordinate origin.
  const Vector origin = vertex(0);
  double volume = 0;
  Vector first = Vector::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const auto& [i, j, k] : faces) {
    const Vector a = vertex(i) - origin;
    const Vector b = vertex(j) - origin;
    const Vector c = vertex(k) - origin;
    const Vector s = a + b + c;
    const double tetrahedron = a.dot(b.cross(c)) / 6;
    volume += tetrahedron;
    first += tetrahedron / 4 * s;
    second += tetrahedron / 20 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
  }
  const Vector centre = first / volume;
  const Eigen::Matrix3d m = second / volume - centre * centre.transpose();
  const Vector absolute = origin + centre;
  return {volume, {absolute.x(), absolute.y(), absolute.z()}, {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2)}};
}

}  // namespace corpuscle::statistics
