#include "physics/overlap.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.hpp"
#include "physics/overlap_inside.hpp"

namespace corpuscle {
namespace {

using Index3 = std::array<int, 3>;

/// A vertex in the primary box and the period it was moved by: position + image * box is where its cell has it.
struct WrappedVertex {
  Vector3 position;
  Index3 image;
  int cell;
};

/// All vertices, sorted into the boxes of a grid. Periods are unrolled on request: a box has any integer index along a periodic axis.
class VertexGrid {
 public:
  VertexGrid(const CellGeometry& geometry, double pitch) : box_(geometry.box), periodic_{true, true, !geometry.walls_z} {
    for (int a = 0; a < 3; ++a) count_[a] = static_cast<int>(std::clamp(std::floor(box_[a] / pitch), 1.0, 1024.0));
    begin_.assign(static_cast<std::size_t>(count_[0]) * count_[1] * count_[2] + 1, 0);
    std::int64_t total = 0;
    const auto for_vertices = [&](const auto& visit) {
      for (int c = 0; c < static_cast<int>(geometry.cells.size()); ++c)
        for (int v = 0; v < geometry.cells[c].vertex_count; ++v) visit(wrap(geometry.cells[c].positions + 3 * static_cast<std::ptrdiff_t>(v), c));
    };
    for_vertices([&](const WrappedVertex& x) { ++begin_[slot(home(x.position))], ++total; });
    std::int64_t sum = 0;
    for (auto& entry : begin_) std::swap(entry, sum), sum += entry;  // start of each box
    vertices_.resize(total);
    numbers_.resize(total);
    std::vector<std::int64_t> next(begin_.begin(), begin_.end() - 1);
    std::int64_t number = 0;
    for_vertices([&](const WrappedVertex& x) {
      const std::int64_t place = next[slot(home(x.position))]++;
      vertices_[place] = x;
      numbers_[place] = number++;
    });
  }

  /// Calls visit(vertex, its number, its position and period in the unrolled box) for all vertices in the grid boxes first ... last.
  template <class Visit>
  void for_range(const Index3& first, const Index3& last, const Visit& visit) const {
    Index3 i;
    for (i[2] = first[2]; i[2] <= last[2]; ++i[2])
      for (i[1] = first[1]; i[1] <= last[1]; ++i[1])
        for (i[0] = first[0]; i[0] <= last[0]; ++i[0]) {
          Index3 wrapped, period;
          Vector3 shift;
          for (int a = 0; a < 3; ++a) {
            period[a] = i[a] >= 0 ? i[a] / count_[a] : -((count_[a] - 1 - i[a]) / count_[a]);
            wrapped[a] = i[a] - period[a] * count_[a];
            shift[a] = period[a] * box_[a];
          }
          const std::size_t s = slot(wrapped);
          for (std::int64_t k = begin_[s]; k < begin_[s + 1]; ++k) visit(vertices_[k], numbers_[k], vertices_[k].position + shift, period);
        }
  }

  /// Unrolled index of the grid box that holds x.
  Index3 locate(const Vector3& x) const {
    Index3 index;
    for (int a = 0; a < 3; ++a) {
      const double i = std::floor(x[a] / box_[a] * count_[a]);
      index[a] = static_cast<int>(periodic_[a] ? i : std::clamp(i, 0.0, count_[a] - 1.0));
    }
    return index;
  }
  /// The index moved by `step`, not through a wall.
  Index3 moved(Index3 index, int step) const {
    for (int a = 0; a < 3; ++a) index[a] = periodic_[a] ? index[a] + step : std::clamp(index[a] + step, 0, count_[a] - 1);
    return index;
  }
  const std::vector<WrappedVertex>& vertices() const { return vertices_; }
  bool is_single_box() const { return count_ == Index3{1, 1, 1}; }
  /// Two vertices closer than this are in the same or in adjacent boxes.
  double reach() const { return std::min({box_[0] / count_[0], box_[1] / count_[1], box_[2] / count_[2]}); }

 private:
  WrappedVertex wrap(const double* x, int cell) const {
    WrappedVertex result{{x[0], x[1], x[2]}, {0, 0, 0}, cell};
    for (int a = 0; a < 3; ++a)
      if (periodic_[a]) {
        double image = std::floor(x[a] / box_[a]), wrapped = x[a] - image * box_[a];
        if (wrapped >= box_[a]) wrapped = 0, image += 1;  // rounding of a tiny negative coordinate
        result.position[a] = wrapped;
        result.image[a] = static_cast<int>(image);
      }
    return result;
  }
  Index3 home(const Vector3& x) const {
    Index3 index = locate(x);
    for (int a = 0; a < 3; ++a) index[a] = std::clamp(index[a], 0, count_[a] - 1);
    return index;
  }
  std::size_t slot(const Index3& i) const { return (static_cast<std::size_t>(i[2]) * count_[1] + i[1]) * count_[0] + i[0]; }

  std::array<double, 3> box_;
  std::array<bool, 3> periodic_;
  Index3 count_{};
  std::vector<std::int64_t> begin_, numbers_;
  std::vector<WrappedVertex> vertices_;
};

/// Distance of the closest two vertices of different cells, or of one cell and its image, if below grid.reach(); else an upper bound.
double closest_pair(const VertexGrid& grid) {
  double smallest2 = std::numeric_limits<double>::infinity();
  for (const WrappedVertex& x : grid.vertices()) {
    const Index3 here = grid.locate(x.position);
    const auto compare = [&](const WrappedVertex& y, std::int64_t, const Vector3& position, const Index3& period) {
      const double distance2 = (position - x.position).squaredNorm();
      if (distance2 >= smallest2) return;
      // One copy of one cell, not a cell and its image: both are moved by the same period from where the cell has them.
      bool same = y.cell == x.cell;
      for (int a = 0; a < 3; ++a) same = same && y.image[a] - period[a] == x.image[a];
      if (!same) smallest2 = distance2;
    };
    grid.for_range(grid.moved(here, -1), grid.moved(here, 1), compare);
  }
  return std::sqrt(smallest2);
}

double smallest_gap(const CellGeometry& geometry, double pitch) {
  for (;; pitch *= 2) {  // a wider grid only when nothing is near: then few vertices are
    const VertexGrid grid(geometry, pitch);
    const double gap = closest_pair(grid);
    if (gap < grid.reach() || grid.is_single_box()) return gap;
  }
}

void require_finite(const CellGeometry& geometry) {
  for (std::size_t c = 0; c < geometry.cells.size(); ++c)
    for (int i = 0; i < 3 * geometry.cells[c].vertex_count; ++i)
      if (!(std::abs(geometry.cells[c].positions[i]) < 1e12))
        throw SimulationError("Cell " + std::to_string(c) +
                              " has a vertex whose position is not a finite number; the run is unstable: lower the shear rate or the moduli.");
}

}  // namespace

OverlapReport check_overlap(const CellGeometry& geometry) {
  require_finite(geometry);
  OverlapReport report;
  std::int64_t vertex_count = 0;
  for (const CellView& cell : geometry.cells) {
    vertex_count += cell.vertex_count;
    if (geometry.walls_z)
      for (int v = 0; v < cell.vertex_count; ++v) {
        const double z = cell.positions[3 * v + 2];
        report.vertices_outside_walls += z < 0 || z > geometry.box[2];
      }
  }
  if (vertex_count == 0) return report;

  const double volume = geometry.box[0] * geometry.box[1] * geometry.box[2];
  const double pitch = std::cbrt(volume / static_cast<double>(vertex_count));  // about one vertex in a box
  report.smallest_gap = smallest_gap(geometry, pitch);

  const VertexGrid grid(geometry, pitch);
  std::vector<char> is_inside(vertex_count, 0);  // each vertex counts once, however many cells it is in
  InsideTest test;
  for (int c = 0; c < static_cast<int>(geometry.cells.size()); ++c) {
    if (geometry.cells[c].vertex_count == 0) continue;
    test.reset(geometry.cells[c]);
    grid.for_range(grid.locate(test.lower()), grid.locate(test.upper()),
                   [&](const WrappedVertex& x, std::int64_t number, const Vector3& position, const Index3& period) {
                     if ((x.cell == c && x.image == period) || is_inside[number] || !test.contains(position)) return;
                     is_inside[number] = 1;
                     ++report.vertices_inside;
                     if (report.first_cell < 0) report.first_cell = x.cell, report.second_cell = c;
                   });
  }
  return report;
}

}  // namespace corpuscle
