// Do cells overlap each other or the walls? The check after packing, and on restarts.
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "physics/mesh.hpp"

namespace corpuscle {

/// A view on one cell. The pointers must outlive the check.
struct CellView {
  const double* positions = nullptr;                       ///< [vertex_count][3], unwrapped
  int vertex_count = 0;
  const std::vector<std::array<int, 3>>* faces = nullptr;  ///< of its type, outward
};

struct CellGeometry {
  std::array<double, 3> box{};   ///< lattice units
  bool walls_z = true;           ///< walls at z = 0 and box[2]; else periodic in z as well as in x and y
  std::vector<CellView> cells;
};

struct OverlapReport {
  std::int64_t vertices_inside = 0;         ///< vertices that lie inside another cell, or inside a periodic image of their own
  std::int64_t vertices_outside_walls = 0;
  int first_cell = -1, second_cell = -1;    ///< a vertex of the first lies inside the second (equal: inside its own image); -1: no overlap
  double smallest_gap = std::numeric_limits<double>::infinity();  ///< shortest distance of two vertices of different cells (or images of one)

  bool is_clean() const { return vertices_inside == 0 && vertices_outside_walls == 0; }
};

/// All vertices against all cells and periodic images; linear in the number of cells. A vertex on a surface is outside.
/// Cells that pierce each other with edges only, no vertex inside, are not seen; with edges of similar length that is a fraction of an edge at most.
/// @throws SimulationError when a position is not a finite number.
OverlapReport check_overlap(const CellGeometry& geometry);

}  // namespace corpuscle
