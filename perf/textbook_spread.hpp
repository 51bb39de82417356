// Spreading as textbooks write it, one marker after the other with plain adds: what the operator of physics/coupling.hpp is measured against.
#pragma once
#include <cmath>
#include <vector>

#include "core/grid.hpp"

namespace corpuscle::perf {

/// Peskin's functions of the distance in lattice spacings: 2, 3 (Roma et al. 1999), 4 points (Peskin 2002, with the square root).
template <class Real>
Real textbook_delta(int points, Real distance) {
  const Real a = std::abs(distance);
  if (points == 2) return a < 1 ? 1 - a : Real(0);
  if (points == 3) {
    if (a < Real(0.5)) return (1 + std::sqrt(1 - 3 * a * a)) / 3;
    return a < Real(1.5) ? (5 - 3 * a - std::sqrt(std::max(Real(0), 1 - 3 * (1 - a) * (1 - a)))) / 6 : Real(0);
  }
  if (a < 1) return (3 - 2 * a + std::sqrt(1 + 4 * a - 4 * a * a)) / 8;
  return a < 2 ? (5 - 2 * a - std::sqrt(std::max(Real(0), -7 + 12 * a - 4 * a * a))) / 8 : Real(0);
}

/// field [padded nodes][4], as VectorField; positions and forces [V][3] on the host. Periodic in x and y; z periodic, or inside of walls.
template <class Real>
void textbook_spread(const Grid& grid, int points, const std::vector<double>& positions, const std::vector<double>& forces, Real* field) {
  const double length[3] = {double(grid.nx), double(grid.ny), double(grid.nz)};
  for (std::size_t v = 0; v < positions.size(); v += 3) {
    int first[3];
    Real weight[3][4] = {};
    for (int k = 0; k < 3; ++k) {
      const double s = positions[v + k] - length[k] * std::floor(positions[v + k] / length[k]) - 0.5;  // nodes at integers
      first[k] = points == 3 ? int(std::floor(s + 0.5)) - 1 : int(std::floor(s)) - (points == 4 ? 1 : 0);
      for (int i = 0; i < points; ++i) weight[k][i] = textbook_delta(points, Real(s - (first[k] + i)));
    }
    for (int z = 0; z < points; ++z)
      for (int y = 0; y < points; ++y)
        for (int x = 0; x < points; ++x) {
          const Real w = weight[0][x] * weight[1][y] * weight[2][z];
          Real* const node = field + 4 * std::size_t(grid.index(first[0] + x, first[1] + y, first[2] + z));
          for (int k = 0; k < 3; ++k) node[k] += w * Real(forces[v + k]);
        }
  }
}

}  // namespace corpuscle::perf
