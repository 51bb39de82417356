// Forces of a membrane, F = - dE/dx: per triangle (strain, global area and volume) and per edge (bending), added to the vertices by an adder.
#pragma once
#include "core/types.hpp"
#include "kernels/vec3.hpp"

namespace corpuscle {

/// Topology and reference state of a cell type, shared by all of its cells. An edge p -> q has the tips `left` and `right` of its two triangles.
template <class Real>
struct MembraneTables {
  Kokkos::View<int* [3], Kokkos::LayoutRight, MemSpace> faces;                ///< [F][3]
  Kokkos::View<Real* [5], Kokkos::LayoutRight, MemSpace> face_reference;      ///< [F][5], see FaceReference
  Kokkos::View<int* [4], Kokkos::LayoutRight, MemSpace> edges;                ///< [E][4]: p, q, left, right; empty without bending
  Kokkos::View<Real* [2], Kokkos::LayoutRight, MemSpace> edge_reference;      ///< [E][2]: cosine and sine of the reference angle
  enum FaceReference {
    gram_inverse_11,  ///< inverse Gram matrix of the undeformed edges b - a, c - a
    gram_inverse_12,
    gram_inverse_22,
    gram_determinant_inverse,
    area,             ///< undeformed area of the triangle
    face_values
  };
};

/// Global constraints of one cell (or one pack of cells): forces per area and volume gradient; unused without the term.
template <class T>
struct Tension {
  T area;    ///< kappa_A (A - A0)/A0
  T volume;  ///< kappa_V (V - V0)/V0
};

/// Forces of one triangle on its three vertices. `position(v)` returns a vertex as Vec3<T>, `add(v, force)` adds to one; T is Real on devices and a
/// SIMD pack over cells of the same type on hosts.
template <class Real, class T, class Law, bool needs_area, bool needs_volume, class Position, class Add>
KOKKOS_FORCEINLINE_FUNCTION void triangle_forces(const MembraneTables<Real>& tables, const Law& law, const Tension<T>& tension, const int face, const Position& position,
                                                 const Add& add) {
  using Tables = MembraneTables<Real>;
  const int a = tables.faces(face, 0), b = tables.faces(face, 1), c = tables.faces(face, 2);
  const Vec3<T> origin = position(a);
  const Vec3<T> edge_b = position(b) - origin, edge_c = position(c) - origin;
  const auto reference = [&](int k) { return T(tables.face_reference(face, k)); };

  // In-plane strain from the Gram matrix g of the deformed edges: I1 = G^-1 : g - 2, I2 = det g / det G - 1.
  const T g11 = dot(edge_b, edge_b), g12 = dot(edge_b, edge_c), g22 = dot(edge_c, edge_c);
  const T h11 = reference(Tables::gram_inverse_11), h12 = reference(Tables::gram_inverse_12), h22 = reference(Tables::gram_inverse_22);
  const Vec3<T> normal = cross(edge_b, edge_c);
  const T normal_squared = dot(normal, normal);
  const T determinant_inverse = reference(Tables::gram_determinant_inverse);
  const T i1 = h11 * g11 + T(2) * h12 * g12 + h22 * g22 - T(2);
  const T i2 = normal_squared * determinant_inverse - T(1);
  T dw1, dw2;
  law.derivatives(i1, i2, dw1, dw2);
  const T two_area = T(2) * reference(Tables::area);
  dw1 = dw1 * two_area;
  dw2 = dw2 * two_area * determinant_inverse;
  // The gradient of the area has the form of that of det g: d|N|/dx = (d det g/dx)/(2 |N|).
  if constexpr (needs_area) dw2 = dw2 + T(0.5) * tension.area / Kokkos::sqrt(normal_squared);
  Vec3<T> force_b = (dw2 * g12 - dw1 * h12) * edge_c - (dw1 * h11 + dw2 * g22) * edge_b;
  Vec3<T> force_c = (dw2 * g12 - dw1 * h12) * edge_b - (dw1 * h22 + dw2 * g11) * edge_c;
  Vec3<T> force_a = Vec3<T>{T(0), T(0), T(0)} - force_b - force_c;
  if constexpr (needs_volume) {  // dV/dx = N/6 for each corner, summed over a closed surface
    const Vec3<T> pressure = (tension.volume * T(1.0 / 6)) * normal;
    force_a = force_a - pressure;
    force_b = force_b - pressure;
    force_c = force_c - pressure;
  }
  add(a, force_a);
  add(b, force_b);
  add(c, force_c);
}

/// Bending forces of one edge on its four vertices, E = p kappa_B (theta - theta_0)^2; theta > 0 where the surface is convex. stiffness = 2 p kappa_B.
/// The force on a tip is the moment over the height of its triangle, and the stiffness grows with 1/height^2: what no step is short enough for when a fold squeezes a triangle to
/// nothing. The moment of an edge falls with (2 area)^2/`collapsed` of both of its triangles where that is below 1: forces and torques of the edge still sum to zero.
/// @param collapsed (2 area)^2 below which a triangle counts as squeezed
template <class Real, class T, class Position, class Add>
KOKKOS_FORCEINLINE_FUNCTION void edge_forces(const MembraneTables<Real>& tables, const T& stiffness, const T& collapsed, const int e, const Position& position, const Add& add) {
  const int p = tables.edges(e, 0), q = tables.edges(e, 1), left = tables.edges(e, 2), right = tables.edges(e, 3);
  const Vec3<T> origin = position(p);
  const Vec3<T> edge = position(q) - origin, to_left = position(left) - origin, to_right = position(right) - origin;
  const Vec3<T> normal_left = cross(edge, to_left), normal_right = cross(to_right, edge);
  const T squared_length = dot(edge, edge);
  const T length = Kokkos::sqrt(squared_length);
  const T c = dot(normal_left, normal_right), s = T(0) - length * dot(normal_left, to_right);
  const T cos_0 = T(tables.edge_reference(e, 0)), sin_0 = T(tables.edge_reference(e, 1));
  const T moment = stiffness * length * angle_of(s * cos_0 - c * sin_0, c * cos_0 + s * sin_0);
  // dtheta/dl = -|e|/|N_l|^2 N_l at the left tip, likewise at the right one; the ends share the opposite forces by the feet of the tips on the edge.
  const T squared_left = dot(normal_left, normal_left), squared_right = dot(normal_right, normal_right);
  const T bound_left = Kokkos::max(squared_left, collapsed), bound_right = Kokkos::max(squared_right, collapsed);
  const Vec3<T> force_left = (moment * (squared_right / bound_right) / bound_left) * normal_left;
  const Vec3<T> force_right = (moment * (squared_left / bound_left) / bound_right) * normal_right;
  const T inverse = T(1) / squared_length;
  const Vec3<T> force_q = (T(0) - dot(to_left, edge) * inverse) * force_left - (dot(to_right, edge) * inverse) * force_right;
  add(left, force_left);
  add(right, force_right);
  add(q, force_q);
  add(p, Vec3<T>{T(0), T(0), T(0)} - force_left - force_right - force_q);
}

}  // namespace corpuscle
