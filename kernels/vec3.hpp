// Three-vectors over scalars or SIMD packs.
#pragma once
#include <Kokkos_Core.hpp>

namespace corpuscle {

template <class T>
struct Vec3 {
  T x, y, z;
  friend KOKKOS_FORCEINLINE_FUNCTION Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend KOKKOS_FORCEINLINE_FUNCTION Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend KOKKOS_FORCEINLINE_FUNCTION Vec3 operator*(const T& s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
};
template <class T>
KOKKOS_FORCEINLINE_FUNCTION T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
KOKKOS_FORCEINLINE_FUNCTION Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// atan2(s, c) without branches or library calls, so that it vectorises: three halvings of the angle, then the series of atan.
/// Relative error below 1e-15 for |angle| <= pi/2 and below 3e-11 up to pi (double).
template <class T>
KOKKOS_FORCEINLINE_FUNCTION T angle_of(const T& s, const T& c) {
  const T one(1);
  const T t1 = s / (Kokkos::sqrt(s * s + c * c) + c);
  const T t2 = t1 / (one + Kokkos::sqrt(one + t1 * t1));
  const T t = t2 / (one + Kokkos::sqrt(one + t2 * t2));
  const T u = t * t;
  T series(1.0 / 25);
  series = T(1.0 / 23) - u * series;
  series = T(1.0 / 21) - u * series;
  series = T(1.0 / 19) - u * series;
  series = T(1.0 / 17) - u * series;
  series = T(1.0 / 15) - u * series;
  series = T(1.0 / 13) - u * series;
  series = T(1.0 / 11) - u * series;
  series = T(1.0 / 9) - u * series;
  series = T(1.0 / 7) - u * series;
  series = T(1.0 / 5) - u * series;
  series = T(1.0 / 3) - u * series;
  return T(8) * t * (one - u * series);
}

}  // namespace corpuscle
