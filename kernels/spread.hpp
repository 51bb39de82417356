// Spreading: vertex forces become force density on the nodes, f(x) = sum_v F_v delta(x - x_v).
#pragma once
#include "kernels/stencil.hpp"

namespace corpuscle {

/// Adders: how a row of `width` nodes x 4 components is added to the field. Plain where the caller guarantees that no other thread touches the row
/// (host colouring), atomic elsewhere.
struct PlainAdder {
  template <int Width, class Real>
  KOKKOS_FORCEINLINE_FUNCTION static void add_row(Real* row, const Real weight, const Real (&values)[4 * Width]) {
    for (int i = 0; i < 4 * Width; ++i) row[i] += weight * values[i];
  }
};
struct AtomicAdder {
  template <int Width, class Real>
  KOKKOS_FORCEINLINE_FUNCTION static void add_row(Real* row, const Real weight, const Real (&values)[4 * Width]) {
    for (int i = 0; i < Width; ++i)
      for (int k = 0; k < 3; ++k) Kokkos::atomic_add(&row[4 * i + k], weight * values[4 * i + k]);
  }
};

/// Spreads one vertex. positions [V][3] unwrapped; forces [V][3]; field [padded nodes][4]; lattice units.
template <class Real, class Delta, class Adder>
struct Spread {
  Grid grid;
  PeriodicBox box;
  VertexVectors positions, forces;
  VectorField<Real> field;

  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int vertex) const {
    constexpr int width = Delta::width;
    const Stencil<Real, Delta> stencil(box, positions(vertex, 0), positions(vertex, 1), positions(vertex, 2));
    const Real force[4] = {static_cast<Real>(forces(vertex, 0)), static_cast<Real>(forces(vertex, 1)), static_cast<Real>(forces(vertex, 2)), Real(0)};
    Real row[4 * width];  // the x-row of nodes lies in one piece in memory: 16 floats for 4 points
    for (int i = 0; i < width; ++i)
      for (int k = 0; k < 4; ++k) row[4 * i + k] = stencil.wx[i] * force[k];
    for (int j = 0; j < width; ++j)
      for (int i = 0; i < width; ++i)
        Adder::template add_row<width>(&field(grid.index(stencil.x, stencil.y + i, stencil.z + j), 0), stencil.wy[i] * stencil.wz[j], row);
  }
};

}  // namespace corpuscle
