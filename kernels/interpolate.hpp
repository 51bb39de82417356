// Interpolation: velocity of a vertex, u_v = sum_x u(x) delta(x - x_v), with the weights of spreading.
#pragma once
#include "kernels/stencil.hpp"

namespace corpuscle {

/// Velocity at one vertex. field [padded nodes][4] with its halo filled; velocity [3] (written); lattice units.
template <class Real, class Delta>
KOKKOS_FORCEINLINE_FUNCTION void interpolate_vertex(const Stencil<Real, Delta>& stencil, const Grid& grid, const Real* const field, double* const velocity) {
  constexpr int width = Delta::width;
  Real row[4 * width] = {};
  for (int k = 0; k < width; ++k)
    for (int j = 0; j < width; ++j) {
      const Real weight = stencil.wy[j] * stencil.wz[k];
      const Real* const nodes = field + 4 * std::size_t(stencil.node + grid.offset(0, j, k));
#pragma omp simd
      for (int i = 0; i < 4 * width; ++i) row[i] += weight * nodes[i];
    }
  Real sum[4] = {};
  for (int i = 0; i < width; ++i)
    for (int k = 0; k < 4; ++k) sum[k] += stencil.wx[i] * row[4 * i + k];
  for (int k = 0; k < 3; ++k) velocity[k] = static_cast<double>(sum[k]);
}

/// One vertex a call, for devices. positions [V][3] unwrapped; velocities [V][3] (written).
template <class Real, class Delta>
struct Interpolate {
  Grid grid;
  PeriodicBox box;
  VertexVectors positions, velocities;
  VectorField<Real> field;

  KOKKOS_FUNCTION void operator()(const int vertex) const {
    const auto stencil = stencil_at<Real, Delta>(grid, box, positions(vertex, 0), positions(vertex, 1), positions(vertex, 2));
    interpolate_vertex(stencil, grid, field.data(), &velocities(vertex, 0));
  }
};

}  // namespace corpuscle
