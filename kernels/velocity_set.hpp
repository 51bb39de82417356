// D3Q19: directions in opposite pairs (2p+1, 2p+2), weights, speed of sound. Qian, d'Humieres, Lallemand 1992.
#pragma once
#include <Kokkos_Macros.hpp>

#include "core/unroll.hpp"

namespace corpuscle {

/// The first direction of every pair points to +z, or lies in the plane and points to +y or +x: streaming then needs halo planes on few sides,
/// and walls in z are handled on one slot (kernels/streaming.hpp).
struct D3Q19 {
  static constexpr int directions = 19;
  static constexpr int pairs = 9;
  static constexpr int cx[19] = {0, 1, -1, 0, 0, 1, -1, 1, -1, 0, 0, 1, -1, -1, 1, 0, 0, 0, 0};
  static constexpr int cy[19] = {0, 0, 0, 1, -1, 1, -1, -1, 1, 0, 0, 0, 0, 0, 0, 1, -1, -1, 1};
  static constexpr int cz[19] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1};
  static constexpr double rest_weight = 1.0 / 3.0;
  static constexpr double axis_weight = 1.0 / 18.0;
  static constexpr double diagonal_weight = 1.0 / 36.0;
  static constexpr double sound_speed_squared = 1.0 / 3.0;

  static constexpr double weight(int q) {
    return q == 0 ? rest_weight
                  : (cx[q] * cx[q] + cy[q] * cy[q] + cz[q] * cz[q] == 1 ? axis_weight : diagonal_weight);
  }
};

}  // namespace corpuscle
