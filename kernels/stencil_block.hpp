// Stencils of many vertices at once, for hosts: one after the other they cost more than the nodes that they touch (docs/performance.md).
#pragma once
#include "core/flatten.hpp"
#include "kernels/stencil.hpp"

namespace corpuscle {

template <class Real, class Delta>
class StencilBlock {
 public:
  static constexpr int size = 64;
  static constexpr int ahead = 16;  ///< vertices between a prefetch and its use

  /// Stencils of `count` <= size vertices. positions [V][3] unwrapped, lattice units; vertices: their numbers, or none for `first` and those after it.
  template <bool listed>
  CORPUSCLE_FLATTEN void fill(const Grid grid, const PeriodicBox box, const double* __restrict positions, const int count, const int first,
                              const int* __restrict vertices) {
    // Several short loops: in one, the compiler would follow the clamps of `inside` as branches and give up.
    alignas(64) double inside[3][size];
    for (int axis = 0; axis < 3; ++axis) {
#pragma omp simd
      for (int i = 0; i < count; ++i) inside[axis][i] = box.inside(positions[3 * (listed ? vertices[i] : first + i) + axis], axis);
    }
    alignas(64) int at[3][size];
    along(inside[0], count, at[0], wx_);
    along(inside[1], count, at[1], wy_);
    along(inside[2], count, at[2], wz_);
#pragma omp simd
    for (int i = 0; i < count; ++i) node_[i] = grid.index(at[0][i], at[1][i], at[2][i]);
  }
  KOKKOS_FORCEINLINE_FUNCTION Stencil<Real, Delta> operator[](const int i) const {
    Stencil<Real, Delta> s;
    s.node = node_[i];
    for (int k = 0; k < Delta::width; ++k) {
      s.wx[k] = wx_[k][i];
      s.wy[k] = wy_[k][i];
      s.wz[k] = wz_[k][i];
    }
    return s;
  }

  /// Asks for the nodes of a vertex that comes soon: in a step other operators have driven the field out of the caches since it was touched last.
  KOKKOS_FORCEINLINE_FUNCTION void prefetch(const int i, const Grid& grid, const Real* const field) const {
    for (int k = 0; k < Delta::width; ++k)
      for (int j = 0; j < Delta::width; ++j) {
        const Real* const row = field + 4 * std::size_t(node_[i] + grid.offset(0, j, k));
        __builtin_prefetch(row);
        __builtin_prefetch(row + 4 * Delta::width - 1);
      }
  }

 private:
  KOKKOS_FORCEINLINE_FUNCTION static void along(const double (&inside)[size], const int count, int (&node)[size], Real (&weights)[Delta::width][size]) {
#pragma omp simd
    for (int i = 0; i < count; ++i) {
      Real w[Delta::width];
      node[i] = stencil_along<Delta>(inside[i], w);
      for (int k = 0; k < Delta::width; ++k) weights[k][i] = w[k];
    }
  }

  alignas(64) int node_[size];
  alignas(64) Real wx_[Delta::width][size], wy_[Delta::width][size], wz_[Delta::width][size];
};

}  // namespace corpuscle
