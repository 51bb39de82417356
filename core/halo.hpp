// Loops over the halo and the nodes that it mirrors. Periodicity (and later MPI) lives here only: kernels never wrap an index.
#pragma once
#include <string>

#include "core/grid.hpp"
#include "core/types.hpp"

namespace corpuscle {

/// Which interior node a halo node stands for.
enum class HaloPartner {
  periodic,  ///< the node one box length away
  mirror     ///< the node reflected at the wall half-way between the outermost fluid node and the halo
};

namespace detail {
template <class Body>
struct HaloLines {
  Grid grid;
  int dimension, layers;
  HaloPartner partner;
  int u0, u_count, v0;  // the two other coordinates; u is the faster one in memory
  Body body;

  KOKKOS_FORCEINLINE_FUNCTION int node(int along, int u, int v) const {
    return dimension == 0 ? grid.index(along, u, v) : dimension == 1 ? grid.index(u, along, v) : grid.index(u, v, along);
  }
  KOKKOS_FUNCTION void operator()(const int line) const {
    const int u = u0 + line % u_count, v = v0 + line / u_count;
    const int n = dimension == 0 ? grid.nx : dimension == 1 ? grid.ny : grid.nz;
    for (int layer = 0; layer < layers; ++layer) {
      const bool periodic = partner == HaloPartner::periodic;
      body(node(-1 - layer, u, v), node(periodic ? n - 1 - layer : layer, u, v), -1);
      body(node(n + layer, u, v), node(periodic ? layer : n - 1 - layer, u, v), +1);
    }
  }
};
}  // namespace detail

/// Calls body(halo_node, partner_node, side) for `layers` layers on both sides (side = -1, +1) of one dimension. Lower dimensions are covered
/// with their halo, so gathering in the order 0, 1, 2 and scattering in the order 2, 1, 0 takes care of edges and corners.
/// One thread works on a whole line along the dimension: partners that coincide in a thin box are no race.
template <class Body>
void halo_for(const std::string& label, const Grid& grid, int dimension, int layers, HaloPartner partner, const Body& body) {
  const int h = grid.halo;
  int u0, u_count, v0, v_count;
  if (dimension == 0) {
    u0 = 0, u_count = grid.ny, v0 = 0, v_count = grid.nz;
  } else if (dimension == 1) {
    u0 = -h, u_count = grid.nx + 2 * h, v0 = 0, v_count = grid.nz;
  } else {
    u0 = -h, u_count = grid.nx + 2 * h, v0 = -h, v_count = grid.ny + 2 * h;
  }
  Kokkos::parallel_for(label, Kokkos::RangePolicy<ExecSpace, Kokkos::IndexType<int>>(0, u_count * v_count),
                       detail::HaloLines<Body>{grid, dimension, layers, partner, u0, u_count, v0, body});
}

/// The same for the periodic images along x of one row, `length` nodes from `first` on: for bodies that go over rows and do it while the row is in the cache.
template <class Body>
KOKKOS_FORCEINLINE_FUNCTION void halo_of_row(const int first, const int length, const int layers, const Body& body) {
  for (int layer = 0; layer < layers; ++layer) {
    body(first - 1 - layer, first + length - 1 - layer, -1);
    body(first + length + layer, first + layer, +1);
  }
}

}  // namespace corpuscle
