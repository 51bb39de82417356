// What the halo and the walls do to populations that stream in place (kernels/streaming.hpp).
#pragma once
#include "kernels/streaming.hpp"

namespace corpuscle {

/// Copies the neighbour slots that point across one side of the box between halo and owner: to the halo before a step (the slots that
/// collision will read there), back to the owner after it (what it wrote there).
template <class Storage, int Parity>
struct ExchangePopulations {
  Populations<Storage> f;
  int dimension;
  bool to_halo;

  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int halo, const int owner, const int side) const {
    unroll<D3Q19::pairs>([&](auto p) {
      constexpr int a = 2 * decltype(p)::value + 1;
      constexpr int cx = D3Q19::cx[a], cy = D3Q19::cy[a], cz = D3Q19::cz[a];
      const int c = dimension == 0 ? cx : dimension == 1 ? cy : cz;
      if (c == side) {
        constexpr int slot = StreamingSlots<Parity>::neighbour_slot(decltype(p)::value);
        if (to_halo)
          f(slot, halo) = f(slot, owner);
        else
          f(slot, owner) = f(slot, halo);
      }
    });
  }
};

/// Half-way bounce-back of a step of parity `Parity` at a wall in z that moves along x (Ladd 1994): what left the node towards the wall comes back in the
/// opposite direction, f_b = f_a - 6 w c_a . u_wall (and vice versa below). In the in-place layout that is a copy between the two slots of a pair on one node:
/// on the halo node above the upper wall, on the fluid node itself above the lower wall.
template <class Storage, class Compute, int Parity, bool Upper>
struct BounceBack {
  Populations<Storage> f;
  Compute wall_velocity;  ///< along x

  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int node) const {
    unroll<D3Q19::pairs>([&](auto p) {
      constexpr int pair = decltype(p)::value;
      constexpr int a = 2 * pair + 1;
      if constexpr (D3Q19::cz[a] == 1) {
        constexpr Compute momentum = Compute(6 * D3Q19::weight(a) * D3Q19::cx[a]);
        if constexpr (Upper)
          f(StreamingSlots<1 - Parity>::neighbour_slot(pair), node) =
              static_cast<Storage>(static_cast<Compute>(f(StreamingSlots<Parity>::neighbour_slot(pair), node)) - momentum * wall_velocity);
        else
          f(StreamingSlots<1 - Parity>::local_slot(pair), node) =
              static_cast<Storage>(static_cast<Compute>(f(StreamingSlots<Parity>::local_slot(pair), node)) + momentum * wall_velocity);
      }
    });
  }
};

/// Force along x on a wall from the fluid node next to it (momentum exchange), after a step of parity `Parity` and its bounce-back.
template <class Storage, int Parity, bool Upper>
struct WallMomentum {
  Populations<Storage> f;
  PairOffsets offsets;

  KOKKOS_FORCEINLINE_FUNCTION double operator()(const int node, int, int, int) const {
    double sum = 0;
    unroll<D3Q19::pairs>([&](auto p) {
      constexpr int pair = decltype(p)::value;
      constexpr int a = 2 * pair + 1;
      if constexpr (D3Q19::cz[a] == 1 && D3Q19::cx[a] != 0) {
        const int at = Upper ? node + offsets.along[pair] : node;
        constexpr int out = Upper ? StreamingSlots<Parity>::neighbour_slot(pair) : StreamingSlots<Parity>::local_slot(pair);
        constexpr int in = Upper ? StreamingSlots<1 - Parity>::neighbour_slot(pair) : StreamingSlots<1 - Parity>::local_slot(pair);
        constexpr int sign = (Upper ? 1 : -1) * D3Q19::cx[a];
        sum += sign * (double(f(out, at)) + double(f(in, at)));
      }
    });
    return sum;
  }
};

}  // namespace corpuscle
