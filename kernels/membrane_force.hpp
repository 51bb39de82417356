// Force of the membrane on one vertex: F = - dE/dx, gathered over its one-ring (no scatter, no atomics).
#pragma once
#include "core/types.hpp"
#include "kernels/vec3.hpp"

namespace corpuscle {

/// Topology and reference state of a cell type, shared by all of its cells. Row v belongs to the vertex v, column i to the triangle
/// (v, n_i, n_{i+1}) and to the edges (v, n_i) and (n_i, n_{i+1}).
template <class Real>
struct MembraneTables {
  Array1<int> degree;                                                  ///< [V]
  Array2<int> neighbour;                                               ///< [V][max_degree] n_i, counter-clockwise from outside
  Array2<int> opposite;                                                ///< [V][max_degree] vertex beyond the edge (n_i, n_{i+1})
  Kokkos::View<Real** [9], Kokkos::LayoutRight, MemSpace> reference;   ///< [V][max_degree][9], see the enum
  Kokkos::View<int* [3], Kokkos::LayoutRight, MemSpace> faces;         ///< [F][3]
  enum Reference {
    gram_inverse_11,  ///< inverse Gram matrix of the undeformed edges n_i - v, n_{i+1} - v
    gram_inverse_12,
    gram_inverse_22,
    gram_determinant_inverse,
    area,             ///< undeformed area of the triangle
    cos_spoke,        ///< reference angle at the edge (v, n_i)
    sin_spoke,
    cos_rim,          ///< reference angle at the edge (n_i, n_{i+1})
    sin_rim
  };
};

/// Global constraints of one cell (or one pack of cells): forces per area and volume gradient.
template <class T>
struct Tension {
  T area;    ///< kappa_A (A - A0)/A0
  T volume;  ///< kappa_V (V - V0)/V0
};

/// Bending moment of an edge between unnormalised normals n_left and n_right: dE/dtheta = 2 p kappa_B (theta - theta_0). `reach` is the vector from the
/// edge to the tip of the right triangle; theta > 0 where the surface is convex.
template <class T>
KOKKOS_FORCEINLINE_FUNCTION T bending_moment(const Vec3<T>& n_left, const Vec3<T>& n_right, const Vec3<T>& reach, const T& length, const T& cos_0,
                                             const T& sin_0, const T& stiffness) {
  const T c = dot(n_left, n_right);
  const T s = -length * dot(n_left, reach);
  return stiffness * angle_of(s * cos_0 - c * sin_0, c * cos_0 + s * sin_0);
}

/// Force on vertex v. `position(u)` returns the vertex u as Vec3<T>; T is Real on devices and a SIMD pack over cells of the same type on the host.
/// stiffness = 2 p kappa_B.
template <class Real, class T, class Law, bool needs_bending, class Position>
KOKKOS_FORCEINLINE_FUNCTION Vec3<T> membrane_force(const MembraneTables<Real>& tables, const Law& law, const T& stiffness, const Tension<T>& tension,
                                                   const int v, const Position& position) {
  using Tables = MembraneTables<Real>;
  const int degree = tables.degree(v);
  const Vec3<T> origin = position(v);
  Vec3<T> force{T(0), T(0), T(0)};

  // The triangle before the current one: (v, n_{i-1}, n_i).
  Vec3<T> previous_edge = position(tables.neighbour(v, degree - 1)) - origin;
  Vec3<T> edge = position(tables.neighbour(v, 0)) - origin;
  Vec3<T> previous_normal = cross(previous_edge, edge);

  for (int i = 0; i < degree; ++i) {
    const int next_vertex = tables.neighbour(v, i + 1 < degree ? i + 1 : 0);
    const Vec3<T> next_edge = position(next_vertex) - origin;
    const Vec3<T> normal = cross(edge, next_edge);
    const auto reference = [&](int k) { return T(tables.reference(v, i, k)); };

    // In-plane strain from the Gram matrix g of the deformed edges: I1 = G^-1 : g - 2, I2 = det g / det G - 1.
    const T g11 = dot(edge, edge), g12 = dot(edge, next_edge), g22 = dot(next_edge, next_edge);
    const T h11 = reference(Tables::gram_inverse_11), h12 = reference(Tables::gram_inverse_12), h22 = reference(Tables::gram_inverse_22);
    const T normal_squared = dot(normal, normal);
    const T determinant_inverse = reference(Tables::gram_determinant_inverse);
    const T i1 = h11 * g11 + T(2) * h12 * g12 + h22 * g22 - T(2);
    const T i2 = normal_squared * determinant_inverse - T(1);
    T dw1, dw2;
    law.derivatives(i1, i2, dw1, dw2);
    const T two_area = T(2) * reference(Tables::area);
    dw1 = dw1 * two_area;
    dw2 = dw2 * two_area * determinant_inverse;
    force = force + (dw1 * (h11 + h12) + dw2 * (g22 - g12)) * edge + (dw1 * (h12 + h22) + dw2 * (g11 - g12)) * next_edge;

    // Global area and volume: dA/dv = n x (n_{i+1} - n_i)/2 with the unit normal, dV/dv = normal/6.
    const Vec3<T> rim = next_edge - edge;
    const T inverse_length = T(1) / Kokkos::sqrt(normal_squared);
    force = force - (T(0.5) * tension.area * inverse_length) * cross(normal, rim) - (tension.volume * T(1.0 / 6)) * normal;

    if constexpr (needs_bending) {
      const T inverse_squared = inverse_length * inverse_length;
      // v as an end of the edge (v, n_i) between this triangle (left) and the previous one (right):
      // dtheta/dv = -(1 - t_l) dtheta/dl - (1 - t_r) dtheta/dr, dtheta/dl = -|e|/|N|^2 N.
      const T length = Kokkos::sqrt(g11);
      const T spoke = bending_moment(normal, previous_normal, previous_edge, length, reference(Tables::cos_spoke), reference(Tables::sin_spoke), stiffness);
      const T along_left = T(1) - g12 / g11;
      const T along_right = T(1) - dot(previous_edge, edge) / g11;
      const T right = length / dot(previous_normal, previous_normal);
      force = force - (spoke * length * along_left * inverse_squared) * normal - (spoke * right * along_right) * previous_normal;
      // v as the tip opposite to the edge (n_i, n_{i+1}).
      const Vec3<T> outer = position(tables.opposite(v, i)) - origin - edge;
      const T rim_length = Kokkos::sqrt(dot(rim, rim));
      const T moment = bending_moment(normal, cross(outer, rim), outer, rim_length, reference(Tables::cos_rim), reference(Tables::sin_rim), stiffness);
      force = force + (moment * rim_length * inverse_squared) * normal;
    }
    previous_edge = edge;
    previous_normal = normal;
    edge = next_edge;
  }
  return force;
}

}  // namespace corpuscle
