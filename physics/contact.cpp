#include "physics/contact.hpp"

#include <fmt/format.h>

#include <Kokkos_BitManipulation.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"

namespace corpuscle {
namespace {

/// A state that breaks between two guards may throw all vertices to one place, where every one is a neighbour of every other: the search would take hours. The densest healthy
/// meshes (edge 0.4, range 3) put some hundreds into a bin.
constexpr int most_in_a_bin = 4096;

using DynamicRange = Kokkos::RangePolicy<ExecSpace, Kokkos::Schedule<Kokkos::Dynamic>, Kokkos::IndexType<int>>;

/// Cells that touch have all the work: threads fetch it in portions.
DynamicRange portions(const int vertices) { return DynamicRange(0, vertices).set_chunk_size(512); }

/// Counts or writes the neighbours of the vertex that lies at place i of the bins. Bins that follow each other along x are one run of memory, which is searched in single
/// precision with a reach that covers the rounding.
struct FindNeighbours {
  PeriodicBox box;
  BinGrid grid;
  VertexVectors positions;
  Array1<int> bin_begin, bin_order;
  BinnedVertices binned;
  NeighbourRows rows;
  double reach;
  bool own_images;  ///< a cell may be within reach of its own periodic images
  bool write;       ///< false: begin(v) becomes the number of neighbours; true: begin are offsets, and list is filled

  static constexpr int lanes = BinnedVertices::lanes;
  struct Search {
    int vertex, found, cell;
    float at[3], period[3], reach_squared;
  };

  KOKKOS_FORCEINLINE_FUNCTION static float nearest(const float difference, const float period) {
    const float d = Kokkos::fabs(difference), image = period - d;
    return d < image ? d : image;
  }
  KOKKOS_FORCEINLINE_FUNCTION void run(Search& s, const int first_bin, const int last_bin) const {
    const int last = bin_begin(last_bin + 1);
    const float ax = s.at[0], ay = s.at[1], az = s.at[2], lx = s.period[0], ly = s.period[1], lz = s.period[2], reach_squared = s.reach_squared;
    const int excluded = own_images ? -1 : s.cell;
    for (int start = bin_begin(first_bin); start < last; start += lanes) {
      const float* const px = &binned.place(0, start);
      const float* const py = &binned.place(1, start);
      const float* const pz = &binned.place(2, start);
      const int* const cell = &binned.cell(start);
      unsigned near = 0;  // a bit a lane
#pragma omp simd reduction(+ : near)
      for (int lane = 0; lane < lanes; ++lane) {
        const float x = nearest(px[lane] - ax, lx), y = nearest(py[lane] - ay, ly), z = nearest(pz[lane] - az, lz);
        near += (x * x + y * y + z * z < reach_squared) & (cell[lane] != excluded) ? 1u << lane : 0u;
      }
      if (last - start < lanes) near &= (1u << (last - start)) - 1;
      if (write || own_images)
        for (; near != 0; near &= near - 1) look_at(s, start + Kokkos::countr_zero(near));
      else
        s.found += Kokkos::popcount(near);
    }
  }
  KOKKOS_FORCEINLINE_FUNCTION void look_at(Search& s, const int j) const {
    const int u = bin_order(j);
    if (own_images && binned.cell(j) == s.cell && (u == s.vertex || PairVector(box, positions, s.vertex, u).same_image)) return;
    if (write) insert(s, u);
    ++s.found;
  }
  /// In ascending order: sums over a row then don't depend on when the lists were built.
  KOKKOS_FORCEINLINE_FUNCTION void insert(const Search& s, const int u) const {
    const int begin = rows.begin(s.vertex);
    int place = begin + s.found;
    for (; place > begin && rows.list(place - 1) > u; --place) rows.list(place) = rows.list(place - 1);
    rows.list(place) = u;
  }
  KOKKOS_FORCEINLINE_FUNCTION int low(const int axis) const { return grid.count[axis] >= 3 ? -1 : 0; }
  KOKKOS_FORCEINLINE_FUNCTION int high(const int axis) const { return grid.count[axis] >= 2 ? 1 : 0; }

  KOKKOS_FUNCTION void operator()(const int i) const {
    Search s;
    s.vertex = bin_order(i);
    s.found = 0;
    if (write && rows.begin(s.vertex) == rows.begin(s.vertex + 1)) return;
    s.cell = binned.cell(i);
    int c[3];
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      c[k] = grid.coordinate(box.inside(positions(s.vertex, k), k), k);
      s.at[k] = binned.place(k, i);
      s.period[k] = k == 2 && box.walls ? 3e38f : static_cast<float>(box.length[k]);
      longest = box.length[k] > longest ? box.length[k] : longest;
    }
    const float padded = static_cast<float>(reach + 1e-6 * longest);  // each position is rounded by 2^-24 of the box
    s.reach_squared = padded * padded;
    const int along_x = grid.count[0];
    for (int dz = low(2); dz <= high(2); ++dz) {
      int z = c[2] + dz;
      if (box.walls && (z < 0 || z >= grid.count[2]) && grid.count[2] >= 3) continue;
      z = (z + grid.count[2]) % grid.count[2];
      for (int dy = low(1); dy <= high(1); ++dy) {
        const int y = (c[1] + dy + grid.count[1]) % grid.count[1];
        const int row = grid.bin(0, y, z);
        if (along_x < 3) {
          run(s, row, row + along_x - 1);
          continue;
        }
        run(s, row + (c[0] > 0 ? c[0] - 1 : 0), row + (c[0] < along_x - 1 ? c[0] + 1 : c[0]));
        if (c[0] == 0) run(s, row + along_x - 1, row + along_x - 1);
        if (c[0] == along_x - 1) run(s, row, row);
      }
    }
    if (!write) rows.begin(s.vertex) = s.found;
  }
};

struct BinKeys {
  PeriodicBox box;
  BinGrid grid;
  VertexVectors positions, built_at;
  Array1<int> keys;
  KOKKOS_FUNCTION void operator()(const int v) const {
    int c[3];
    for (int k = 0; k < 3; ++k) {
      c[k] = grid.coordinate(box.inside(positions(v, k), k), k);
      built_at(v, k) = positions(v, k);
    }
    keys(v) = grid.bin(c[0], c[1], c[2]);
  }
};

/// Places in the order of the bins.
struct BinVertices {
  PeriodicBox box;
  VertexVectors positions;
  Array1<int> cell_of_vertex, order;
  BinnedVertices binned;
  KOKKOS_FUNCTION void operator()(const int i) const {
    const int v = order(i);
    for (int k = 0; k < 3; ++k) binned.place(k, i) = static_cast<float>(box.inside(positions(v, k), k));
    binned.cell(i) = cell_of_vertex(v);
  }
};

/// Counts the vertices that are so far from the first one of their cell that the cell may reach one of its images.
struct FarFromFirst {
  PeriodicBox box;
  VertexVectors positions;
  Array1<int> cell_of_vertex, first_vertex;
  double reach;
  KOKKOS_FUNCTION void operator()(const int v, int& far) const {
    const int first = first_vertex(cell_of_vertex(v));
    bool found = false;
    for (int k = 0; k < 3; ++k)
      found = found || (!(k == 2 && box.walls) && !(2 * Kokkos::fabs(positions(v, k) - positions(first, k)) < box.length[k] - reach));
    far += found;
  }
};

struct ContactForce {
  PeriodicBox box;
  Repulsion repulsion;
  VertexVectors positions, forces;
  NeighbourRows rows;
  KOKKOS_FUNCTION void operator()(const int v) const {
    const int first = rows.begin(v), last = rows.begin(v + 1);
    const bool near_wall = box.walls && !(positions(v, 2) >= repulsion.range && positions(v, 2) <= box.length[2] - repulsion.range);
    if (first == last && !near_wall) return;  // most vertices: the forces need not be touched
    double f[3] = {};
    for (int i = first; i < last; ++i) {
      const PairVector pair(box, positions, v, rows.list(i));
      const double scale = pair_force_scale(repulsion, pair);
      for (int k = 0; k < 3; ++k) f[k] += scale * pair.d[k];
    }
    if (near_wall) f[2] += repulsion.magnitude(positions(v, 2)) - repulsion.magnitude(box.length[2] - positions(v, 2));
    for (int k = 0; k < 3; ++k) forces(v, k) += f[k];
  }
};

// Free functions, because CUDA takes no lambda inside a private member.
double largest_move_squared(const VertexVectors& x, const VertexVectors& x0) {
  double moved = 0;
  Kokkos::parallel_reduce("contact_moved", Kokkos::RangePolicy<ExecSpace>(0, x.extent(0)), KOKKOS_LAMBDA(const int v, double& largest) {
    double squared = 0;
    for (int k = 0; k < 3; ++k) squared += (x(v, k) - x0(v, k)) * (x(v, k) - x0(v, k));
    largest = squared > largest ? squared : largest;
  }, Kokkos::Max<double>(moved));
  return moved;
}

/// First vertex of each cell, by its number.
Array1<int> first_vertices(const Array1<int>& cell_of_vertex) {
  const auto cells = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, cell_of_vertex);
  const int vertices = int(cells.extent(0));
  int count = 0;
  for (int v = 0; v < vertices; ++v) count = std::max(count, cells(v) + 1);
  const Array1<int> first("contact_first_vertex", count);
  const auto host = Kokkos::create_mirror_view(first);
  for (int v = vertices - 1; v >= 0; --v) host(cells(v)) = v;
  Kokkos::deep_copy(first, host);
  return first;
}

/// Vertices in the fullest bin.
int fullest_bin(const Array1<int>& begin, const int bins) {
  int fullest = 0;
  Kokkos::parallel_reduce("contact_fullest_bin", Kokkos::RangePolicy<ExecSpace>(0, bins), KOKKOS_LAMBDA(const int b, int& most) {
    const int count = begin(b + 1) - begin(b);
    most = count > most ? count : most;
  }, Kokkos::Max<int>(fullest));
  return fullest;
}

/// In place: the counts in begin(0) ... begin(n - 1) become offsets, begin(n) the total, which is also returned. Offsets are right where the total is an int.
std::int64_t counts_to_offsets(const Array1<int>& begin) {
  const int rows = int(begin.extent(0)) - 1;
  std::int64_t total = 0;
  Kokkos::parallel_scan("contact_scan", Kokkos::RangePolicy<ExecSpace>(0, rows + 1), KOKKOS_LAMBDA(const int v, std::int64_t& sum, const bool final) {
    const int count = v < rows ? begin(v) : 0;
    if (final) begin(v) = static_cast<int>(sum);
    sum += count;
  }, total);
  return total;
}

}  // namespace

Contact::Contact(const PeriodicBox& box, const ContactParameters& parameters, const Array1<int>& cell_of_vertex)
    : box_(box),
      parameters_(parameters),
      cell_of_vertex_(cell_of_vertex),
      first_vertex_(first_vertices(cell_of_vertex)),
      keys_("contact_keys", cell_of_vertex.extent(0)),
      grid_(box.length, parameters.range + parameters.skin),
      binned_{Array2<float>("contact_binned", 3, cell_of_vertex.extent(0) + BinnedVertices::lanes),
              Array1<int>("contact_binned_cell", cell_of_vertex.extent(0) + BinnedVertices::lanes)},
      built_at_("contact_built_at", cell_of_vertex.extent(0)) {
  rows_.begin = Array1<int>("contact_begin", cell_of_vertex.extent(0) + 1);
}

bool Contact::lists_hold(const VertexVectors& positions) {
  if (rebuilds_ == 0) return false;
  ++calls_;
  if (calls_ < next_test_) return true;
  const double moved = std::sqrt(largest_move_squared(positions, built_at_)), allowed = 0.5 * parameters_.skin;
  if (!(moved < allowed)) return false;
  // The test waits for the device, and reads all positions: it is left out while vertices can't leave the skin.
  const double fastest = std::max({parameters_.expected_move, 2 * moved / calls_, 2 * (moved - moved_before_) / (calls_ - tested_at_)});
  tested_at_ = calls_;
  moved_before_ = moved;
  next_test_ = calls_ + (parameters_.expected_move > 0 ? std::max(1, int((allowed - moved) / fastest)) : 1);
  return true;
}

void Contact::update_lists(const VertexVectors& positions) {
  if (lists_hold(positions)) return;
  const int vertices = int(positions.extent(0));
  ++rebuilds_;
  calls_ = tested_at_ = 0;
  moved_before_ = 0;
  next_test_ = 1;
  Kokkos::parallel_for("contact_keys", Kokkos::RangePolicy<ExecSpace>(0, vertices), BinKeys{box_, grid_, positions, built_at_, keys_});
  bins_.build(keys_, vertices, grid_.bins());
  const int fullest = fullest_bin(bins_.begin(), grid_.bins());
  if (fullest > most_in_a_bin) {
    rebuilds_ = 0;  // there are no lists
    throw SimulationError(fmt::format("{} vertices lie within {:.3g} lattice units of each other: cells lie on top of each other, or all at a wall, so the state is broken.", fullest,
                                      parameters_.range + parameters_.skin));
  }
  Kokkos::parallel_for("contact_bin", Kokkos::RangePolicy<ExecSpace>(0, vertices), BinVertices{box_, positions, cell_of_vertex_, bins_.order(), binned_});
  const double reach = parameters_.range + parameters_.skin;
  int far = 0;
  Kokkos::parallel_reduce("contact_own_images", Kokkos::RangePolicy<ExecSpace>(0, vertices), FarFromFirst{box_, positions, cell_of_vertex_, first_vertex_, reach}, far);
  FindNeighbours find{box_, grid_, positions, bins_.begin(), bins_.order(), binned_, rows_, reach, far > 0, false};
  Kokkos::parallel_for("contact_count", portions(vertices), find);
  const std::int64_t pairs = counts_to_offsets(rows_.begin);
  if (pairs > std::numeric_limits<int>::max()) {
    rebuilds_ = 0;
    throw SimulationError(fmt::format("{} pairs of vertices are in reach of contact forces, {} are supported: lower contact.range, or the state is broken.", pairs,
                                      std::numeric_limits<int>::max()));
  }
  const int total = int(pairs);
  if (int(rows_.list.extent(0)) < total)
    rows_.list = Array1<int>(Kokkos::view_alloc(Kokkos::WithoutInitializing, "contact_list"), total + total / 4);
  find.rows = rows_;
  find.write = true;
  Kokkos::parallel_for("contact_fill", portions(vertices), find);
}

void Contact::add_forces(const VertexVectors& positions, const VertexVectors& forces) {
  update_lists(positions);
  Kokkos::parallel_for("contact_forces", portions(int(positions.extent(0))), ContactForce{box_, {parameters_.strength, parameters_.range}, positions, forces, rows_});
}

double Contact::smallest_gap(const VertexVectors& positions) {
  update_lists(positions);
  const auto box = box_;
  const auto x = positions;
  const auto rows = rows_;
  double squared = 0;
  Kokkos::parallel_reduce("contact_gap", Kokkos::RangePolicy<ExecSpace>(0, positions.extent(0)), KOKKOS_LAMBDA(const int v, double& least) {
    for (int i = rows.begin(v); i < rows.begin(v + 1); ++i) {
      const double d = PairVector(box, x, v, rows.list(i)).squared();
      least = d < least ? d : least;
    }
  }, Kokkos::Min<double>(squared));
  const double reach = parameters_.range + parameters_.skin;
  return squared < reach * reach ? std::sqrt(squared) : reach;
}

std::size_t Contact::bytes() const {
  return (cell_of_vertex_.span() + first_vertex_.span() + binned_.cell.span() + keys_.span() + rows_.begin.span() + rows_.list.span()) * sizeof(int) +
         built_at_.span() * sizeof(double) + binned_.place.span() * sizeof(float) + bins_.bytes();
}

}  // namespace corpuscle
