// In-place streaming: Esoteric Pull (Lehmann, Computation 10, 92 (2022)). One copy of the populations; every memory slot is read and written by
// the same node in a step, so that threads never race.
#pragma once
#include "core/grid.hpp"
#include "core/types.hpp"
#include "kernels/velocity_set.hpp"

namespace corpuscle {

/// Where the populations of a node lie before collision at a step of the given parity (step mod 2). For the pair (a, b = opposite of a):
///   f_a at the node itself, slot `local_slot`; f_b at the neighbour along c_a, slot `neighbour_slot`.
/// After collision f_b goes to the local and f_a to the neighbour slot. Everything that looks at populations (collision, walls, initial
/// state, macroscopic fields, checkpoints) goes through these two functions.
template <int Parity>
struct StreamingSlots {
  static constexpr int local_slot(int pair) { return 2 * pair + (Parity == 0 ? 2 : 1); }
  static constexpr int neighbour_slot(int pair) { return 2 * pair + (Parity == 0 ? 1 : 2); }
};

/// Distance in memory between two populations of a node. A stride of k * 4096 bytes would map the same node of all 19 populations to the same cache set (1.3-2x slower); 192 bytes more spread them.
template <class Storage>
constexpr std::size_t population_stride(std::size_t nodes) {
  const std::size_t page = 4096 / sizeof(Storage), shift = 192 / sizeof(Storage);
  const std::size_t pages = nodes > shift ? (nodes - shift + page - 1) / page : 0;
  return pages * page + shift;
}

/// Distances in memory to the neighbours along the first direction of each pair.
struct PairOffsets {
  int along[D3Q19::pairs];
  explicit PairOffsets(const Grid& grid) {
    for (int p = 0; p < D3Q19::pairs; ++p)
      along[p] = grid.offset(D3Q19::cx[2 * p + 1], D3Q19::cy[2 * p + 1], D3Q19::cz[2 * p + 1]);
  }
};

/// Reads and writes the 19 populations of a node. `Storage` in memory, `Compute` in registers.
template <class Storage, class Compute, int Parity>
struct StreamingAccessor {
  Populations<Storage> f;  ///< [19][stride], shifted by the weights
  PairOffsets offsets;

  /// Populations before collision.
  KOKKOS_FORCEINLINE_FUNCTION void load(const int node, Compute (&g)[19]) const {
    g[0] = static_cast<Compute>(f(0, node));
    unroll<D3Q19::pairs>([&](auto p) {
      g[2 * p + 1] = static_cast<Compute>(f(StreamingSlots<Parity>::local_slot(p), node));
      g[2 * p + 2] = static_cast<Compute>(f(StreamingSlots<Parity>::neighbour_slot(p), node + offsets.along[p]));
    });
  }
  /// Populations after collision; they are on their way to the neighbours.
  KOKKOS_FORCEINLINE_FUNCTION void store(const int node, const Compute (&g)[19]) const {
    f(0, node) = static_cast<Storage>(g[0]);
    unroll<D3Q19::pairs>([&](auto p) {
      f(StreamingSlots<Parity>::neighbour_slot(p), node + offsets.along[p]) = static_cast<Storage>(g[2 * p + 1]);
      f(StreamingSlots<Parity>::local_slot(p), node) = static_cast<Storage>(g[2 * p + 2]);
    });
  }
  /// Periodic images along x of the slots that a row of `length` nodes from `first` on reads beyond its ends (ToHalo, before it streams) or has written there (after it): what
  /// `ExchangePopulations` along x does to the whole lattice, done while the lines are in the cache. Rows have no slot in common, so they need no order.
  template <bool ToHalo>
  KOKKOS_FORCEINLINE_FUNCTION void wrap_row(const int first, const int length) const {
    unroll<D3Q19::pairs>([&](auto p) {
      constexpr int cx = D3Q19::cx[2 * decltype(p)::value + 1];
      if constexpr (cx != 0) {
        constexpr int slot = StreamingSlots<Parity>::neighbour_slot(decltype(p)::value);
        const int row = first + offsets.along[p] - cx;  // that the neighbours lie in
        Storage& halo = f(slot, cx > 0 ? row + length : row - 1);
        Storage& owner = f(slot, cx > 0 ? row : row + length - 1);
        if constexpr (ToHalo) halo = owner;
        else owner = halo;
      }
    });
  }
  /// Sets populations before collision (initial state, checkpoints): the inverse of `load`.
  KOKKOS_FORCEINLINE_FUNCTION void set(const int node, const Compute (&g)[19]) const {
    f(0, node) = static_cast<Storage>(g[0]);
    unroll<D3Q19::pairs>([&](auto p) {
      f(StreamingSlots<Parity>::local_slot(p), node) = static_cast<Storage>(g[2 * p + 1]);
      f(StreamingSlots<Parity>::neighbour_slot(p), node + offsets.along[p]) = static_cast<Storage>(g[2 * p + 2]);
    });
  }
  /// The memory of one population before collision.
  KOKKOS_FORCEINLINE_FUNCTION Storage& slot(const int node, const int direction) const {
    if (direction == 0) return f(0, node);
    const int pair = (direction - 1) / 2;
    return direction % 2 == 1 ? f(StreamingSlots<Parity>::local_slot(pair), node) : f(StreamingSlots<Parity>::neighbour_slot(pair), node + offsets.along[pair]);
  }
};

}  // namespace corpuscle
