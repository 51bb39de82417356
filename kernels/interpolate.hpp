// Interpolation: velocity of a vertex, u_v = sum_x u(x) delta(x - x_v), with the weights of spreading.
#pragma once
#include "kernels/stencil.hpp"

namespace corpuscle {

/// positions [V][3] unwrapped; velocities [V][3] (written); field [padded nodes][4] with its halo filled; lattice units.
template <class Real, class Delta>
struct Interpolate {
  Grid grid;
  PeriodicBox box;
  VertexVectors positions, velocities;
  VectorField<Real> field;

  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int vertex) const {
    constexpr int width = Delta::width;
    const Stencil<Real, Delta> stencil(box, positions(vertex, 0), positions(vertex, 1), positions(vertex, 2));
    Real row[4 * width] = {};
    for (int j = 0; j < width; ++j)
      for (int i = 0; i < width; ++i) {
        const Real weight = stencil.wy[i] * stencil.wz[j];
        const Real* const nodes = &field(grid.index(stencil.x, stencil.y + i, stencil.z + j), 0);
        for (int k = 0; k < 4 * width; ++k) row[k] += weight * nodes[k];
      }
    for (int k = 0; k < 3; ++k) {
      Real sum = 0;
      for (int i = 0; i < width; ++i) sum += stencil.wx[i] * row[4 * i + k];
      velocities(vertex, k) = static_cast<double>(sum);
    }
  }
};

}  // namespace corpuscle
