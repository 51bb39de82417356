// Spreading: vertex forces become force density on the nodes, f(x) = sum_v F_v delta(x - x_v).
#pragma once
#include "core/unroll.hpp"
#include "kernels/stencil.hpp"

namespace corpuscle {

/// Adders: how a row of `width` nodes x 4 components is added to the field. Plain where the caller guarantees that no other thread touches the row
/// (host colouring), atomic elsewhere. Without the pragma the compiler unrolls the row into single floats (2.5x slower).
struct PlainAdder {
  template <int Width, class Real>
  KOKKOS_FORCEINLINE_FUNCTION static void add_row(Real* row, const Real weight, const Real (&values)[4 * Width]) {
#pragma omp simd
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

/// Spreads the force of one vertex. field [padded nodes][4]; lattice units.
template <class Adder, class Real, class Delta>
KOKKOS_FORCEINLINE_FUNCTION void spread_vertex(const Stencil<Real, Delta>& stencil, const Real fx, const Real fy, const Real fz, const Grid& grid, Real* const field) {
  constexpr int width = Delta::width;
  const Real force[4] = {fx, fy, fz, Real(0)};
  Real row[4 * width];  // the x-row of nodes lies in one piece in memory: 16 floats for 4 points
  for (int i = 0; i < width; ++i)
    for (int k = 0; k < 4; ++k) row[4 * i + k] = stencil.wx[i] * force[k];
  unroll<width>([&](auto k) {  // a device keeps the row in registers only if its loops have no counters left
    unroll<width>([&](auto j) {
      Adder::template add_row<width>(field + 4 * std::size_t(stencil.node + grid.offset(0, j, k)), stencil.wy[j] * stencil.wz[k], row);
    });
  });
}

/// One vertex a call, for devices. positions [V][3] unwrapped; forces [V][3]; field [padded nodes][4]; lattice units.
template <class Real, class Delta>
struct Spread {
  Grid grid;
  PeriodicBox box;
  VertexVectors positions, forces;
  VectorField<Real> field;

  KOKKOS_FUNCTION void operator()(const int vertex) const {
    const auto stencil = stencil_at<Real, Delta>(grid, box, positions(vertex, 0), positions(vertex, 1), positions(vertex, 2));
    spread_vertex<AtomicAdder>(stencil, Real(forces(vertex, 0)), Real(forces(vertex, 1)), Real(forces(vertex, 2)), grid, field.data());
  }
};

}  // namespace corpuscle
