// How far a point lies from a triangulated surface, and on which side: the sign is that of the pseudonormal at the closest point.
// Baerentzen, Aanaes, IEEE Trans. Vis. Comput. Graph. 11, 243 (2005); closest point of a triangle: Ericson, Real-Time Collision Detection, 5.1.5.
// And, slower but never ambiguous, by all triangles of a closed surface: the side is that of the winding number, Van Oosterom & Strackee,
// IEEE Trans. Biomed. Eng. 30, 125 (1983).
#pragma once
#include "kernels/vec3.hpp"

namespace corpuscle {

/// Looks at one triangle after the other, all around vertices of the surface. Only closest points inside a triangle, or on the two edges and the corner at
/// that vertex count: at the others triangles meet that have not been shown.
struct SignedDistance {
  double squared = 1e300;
  Vec3<double> away{0, 0, 0};    ///< from the closest point
  Vec3<double> normal{0, 0, 0};  ///< pseudonormal there: sum of the unit normals of the triangles that share it, at a corner weighted with their angles

  /// The triangle (0, a, b), outward, seen from its corner at the vertex; `p` the point.
  KOKKOS_FUNCTION void look_at(const Vec3<double>& p, const Vec3<double>& a, const Vec3<double>& b) {
    const Vec3<double> outward = cross(a, b);
    const double size = Kokkos::sqrt(dot(outward, outward));
    if (!(size > 0)) return;
    const double aa = dot(a, a), ab = dot(a, b), bb = dot(b, b), pa = dot(p, a), pb = dot(p, b);
    // Barycentric coordinates of the foot of the perpendicular.
    const double determinant = size * size, s = (bb * pa - ab * pb) / determinant, t = (aa * pb - ab * pa) / determinant;
    Vec3<double> closest{0, 0, 0};
    double weight = 1;
    if (s >= 0 && t >= 0 && s + t <= 1) {
      closest = s * a + t * b;
    } else if (pa <= 0 && pb <= 0) {
      weight = Kokkos::acos(ab / Kokkos::sqrt(aa * bb));
    } else if (t < 0 && pa > 0 && pa < aa) {
      closest = (pa / aa) * a;
    } else if (s < 0 && pb > 0 && pb < bb) {
      closest = (pb / bb) * b;
    } else {
      return;
    }
    const Vec3<double> d = p - closest;
    const double found = dot(d, d);
    constexpr double tie = 1e-9;  // the same point, found in two triangles
    if (found > squared * (1 + tie)) return;
    if (found < squared * (1 - tie)) {
      squared = found;
      away = d;
      normal = Vec3<double>{0, 0, 0};
    }
    normal = normal + (weight / size) * outward;
  }
  /// Depth below the surface; negative outside.
  KOKKOS_FUNCTION double depth() const {
    const double distance = Kokkos::sqrt(squared);
    return dot(away, normal) < 0 ? distance : -distance;
  }
};

/// Half the solid angle of the triangle (a, b, c), outward, seen from the origin: positive where it shows its inner side. In (-pi, pi].
KOKKOS_INLINE_FUNCTION double half_solid_angle(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c) {
  const double la = Kokkos::sqrt(dot(a, a)), lb = Kokkos::sqrt(dot(b, b)), lc = Kokkos::sqrt(dot(c, c));
  return Kokkos::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

/// Squared distance of the origin from the triangle (a, b, c), edges and corners included. A triangle without area counts as its edges.
KOKKOS_INLINE_FUNCTION double triangle_distance_squared(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c) {
  const Vec3<double> normal = cross(b - a, c - a);
  const double size = dot(normal, normal);
  // The foot of the perpendicular is inside when it is on the inner side of all three edges.
  if (size > 0 && dot(cross(a, b), normal) >= 0 && dot(cross(b, c), normal) >= 0 && dot(cross(c, a), normal) >= 0) {
    const double height = dot(a, normal);
    return height * height / size;
  }
  double least = 1e300;
  const Vec3<double> corners[4] = {a, b, c, a};
  for (int k = 0; k < 3; ++k) {
    const Vec3<double> edge = corners[k + 1] - corners[k];
    const double length = dot(edge, edge), along = -dot(corners[k], edge);
    const double t = along <= 0 || !(length > 0) ? 0.0 : along >= length ? 1.0 : along / length;
    const Vec3<double> closest = corners[k] + t * edge;
    const double squared = dot(closest, closest);
    if (squared < least) least = squared;
  }
  return least;
}

/// Looks at all triangles of a closed surface, given relative to the point.
struct DepthInSurface {
  double half_angles = 0, squared = 1e300;

  KOKKOS_FUNCTION void look_at(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c) {
    half_angles += half_solid_angle(a, b, c);
    const double found = triangle_distance_squared(a, b, c);
    if (found < squared) squared = found;
  }
  /// Below the surface; negative outside.
  KOKKOS_FUNCTION double depth() const {
    const double distance = Kokkos::sqrt(squared);
    return half_angles > Kokkos::numbers::pi ? distance : -distance;  // 2 pi inside, 0 outside
  }
};

}  // namespace corpuscle
