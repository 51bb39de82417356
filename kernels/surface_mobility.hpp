// How fast the fluid lets the vertices of a surface move in the step after a kick: the model that the chebyshev vertex update relaxes membranes with.
#pragma once
#include "core/types.hpp"
#include "kernels/vec3.hpp"

namespace corpuscle {

/// u = M F, M = m (1 - s L)^2 with L the Laplacian of the graph of the mesh: symmetric, and small for zigzags, which the delta kernels hardly see and for which membranes are stiffest.
/// All cells of a type share it. Lattice units.
struct SurfaceMobility {
  double mobility = 0;   ///< m
  double smoothing = 0;  ///< s
  int first_vertex = 0, count = 0, vertices = 0;
  Array1<int> degree;     ///< [vertices of one cell]
  Array2<int> neighbour;  ///< [vertices of one cell][max degree]

  /// First factor: row v of (1 - s L)(force - start_force).
  KOKKOS_FORCEINLINE_FUNCTION Vec3<double> smoothed_force(const int v, const VertexVectors& force, const VertexVectors& start_force) const {
    return smooth(v, [&](const int n) {
      return Vec3<double>{force(n, 0) - start_force(n, 0), force(n, 1) - start_force(n, 1), force(n, 2) - start_force(n, 2)};
    });
  }
  /// Second factor: row v of m (1 - s L) smoothed.
  KOKKOS_FORCEINLINE_FUNCTION Vec3<double> velocity(const int v, const VertexVectors& smoothed) const {
    return mobility * smooth(v, [&](const int n) { return Vec3<double>{smoothed(n, 0), smoothed(n, 1), smoothed(n, 2)}; });
  }

 private:
  template <class Field>
  KOKKOS_FORCEINLINE_FUNCTION Vec3<double> smooth(const int v, const Field& field) const {
    const int local = (v - first_vertex) % vertices, base = v - local;
    const int ring = degree(local);
    Vec3<double> sum{0, 0, 0};
    for (int i = 0; i < ring; ++i) sum = sum + field(base + neighbour(local, i));
    return (1 - ring * smoothing) * field(v) + smoothing * sum;
  }
};

}  // namespace corpuscle
