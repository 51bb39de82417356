// The padded index space of the lattice: nx x ny x nz nodes and `halo` layers around them, x fastest.
#pragma once
#include <Kokkos_Macros.hpp>
#include <array>
#include <cstddef>

namespace corpuscle {

/// Node (x, y, z) sits at (x + 1/2, y + 1/2, z + 1/2) in lattice units, so that half-way walls are the planes z = 0 and z = nz.
struct Grid {
  int nx = 0, ny = 0, nz = 0;
  int halo = 1;

  KOKKOS_FORCEINLINE_FUNCTION int pitch_x() const { return nx + 2 * halo; }
  KOKKOS_FORCEINLINE_FUNCTION int pitch_y() const { return ny + 2 * halo; }
  /// Linear index of a node; coordinates may lie in the halo. Fits an int for every lattice below 2^31 nodes (checked in `to_lattice`).
  KOKKOS_FORCEINLINE_FUNCTION int index(int x, int y, int z) const {
    return ((z + halo) * pitch_y() + y + halo) * pitch_x() + x + halo;
  }
  /// Distance in memory to the neighbour at (dx, dy, dz).
  KOKKOS_FORCEINLINE_FUNCTION int offset(int dx, int dy, int dz) const {
    return (dz * pitch_y() + dy) * pitch_x() + dx;
  }
  std::size_t nodes() const { return std::size_t(nx) * ny * nz; }
  std::size_t padded_nodes() const { return std::size_t(pitch_x()) * pitch_y() * (nz + 2 * halo); }
};

}  // namespace corpuscle
