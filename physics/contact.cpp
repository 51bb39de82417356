#include "physics/contact.hpp"

namespace corpuscle {
namespace {

/// Counts (list empty) or writes the neighbours of a vertex, in ascending bin order.
struct FindNeighbours {
  PeriodicBox box;
  BinGrid grid;
  VertexVectors positions;
  Array1<int> cell_of_vertex, bin_begin, bin_order, count_or_begin, list;
  double reach;
  bool write;

  KOKKOS_FORCEINLINE_FUNCTION int low(const int axis) const { return grid.count[axis] >= 3 ? -1 : 0; }
  KOKKOS_FORCEINLINE_FUNCTION int high(const int axis) const { return grid.count[axis] >= 2 ? 1 : 0; }

  KOKKOS_FUNCTION void operator()(const int v) const {
    int c[3], found = 0;
    for (int k = 0; k < 3; ++k) c[k] = grid.coordinate(box.inside(positions(v, k), k), k);
    for (int dz = low(2); dz <= high(2); ++dz) {
      int z = c[2] + dz;
      if (box.walls && (z < 0 || z >= grid.count[2]) && grid.count[2] >= 3) continue;
      z = (z + grid.count[2]) % grid.count[2];
      for (int dy = low(1); dy <= high(1); ++dy) {
        const int y = (c[1] + dy + grid.count[1]) % grid.count[1];
        for (int dx = low(0); dx <= high(0); ++dx) {
          const int bin = grid.bin((c[0] + dx + grid.count[0]) % grid.count[0], y, z);
          for (int i = bin_begin(bin); i < bin_begin(bin + 1); ++i) {
            const int u = bin_order(i);
            if (u == v) continue;
            const PairVector pair(box, positions, v, u);
            if (!(pair.squared() < reach * reach)) continue;  // not a number: no neighbour (the guards report it)
            if (cell_of_vertex(u) == cell_of_vertex(v) && pair.same_image) continue;
            if (write) list(count_or_begin(v) + found) = u;
            ++found;
          }
        }
      }
    }
    if (!write) count_or_begin(v) = found;
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

struct ContactForce {
  PeriodicBox box;
  Repulsion repulsion;
  VertexVectors positions, forces;
  NeighbourRows rows;
  KOKKOS_FUNCTION void operator()(const int v) const {
    double f[3] = {};
    for (int i = rows.begin(v); i < rows.begin(v + 1); ++i) {
      const PairVector pair(box, positions, v, rows.list(i));
      const double scale = pair_force_scale(repulsion, pair);
      for (int k = 0; k < 3; ++k) f[k] += scale * pair.d[k];
    }
    if (box.walls) f[2] += repulsion.magnitude(positions(v, 2)) - repulsion.magnitude(box.length[2] - positions(v, 2));
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

/// In place: the counts in begin(0) ... begin(n - 1) become offsets, begin(n) the total, which is also returned.
int counts_to_offsets(const Array1<int>& begin) {
  const int rows = int(begin.extent(0)) - 1;
  int total = 0;
  Kokkos::parallel_scan("contact_scan", Kokkos::RangePolicy<ExecSpace>(0, rows + 1), KOKKOS_LAMBDA(const int v, int& sum, const bool final) {
    const int count = v < rows ? begin(v) : 0;
    if (final) begin(v) = sum;
    sum += count;
  }, total);
  return total;
}

}  // namespace

Contact::Contact(const PeriodicBox& box, const ContactParameters& parameters, const Array1<int>& cell_of_vertex)
    : box_(box),
      parameters_(parameters),
      cell_of_vertex_(cell_of_vertex),
      keys_("contact_keys", cell_of_vertex.extent(0)),
      grid_(box.length, parameters.range + parameters.skin),
      built_at_("contact_built_at", cell_of_vertex.extent(0)) {
  rows_.begin = Array1<int>("contact_begin", cell_of_vertex.extent(0) + 1);
}

void Contact::update_lists(const VertexVectors& positions) {
  const int vertices = int(positions.extent(0));
  if (rebuilds_ > 0) {
    const double moved = largest_move_squared(positions, built_at_);
    if (4 * moved < parameters_.skin * parameters_.skin) return;
  }
  ++rebuilds_;
  Kokkos::parallel_for("contact_keys", Kokkos::RangePolicy<ExecSpace>(0, vertices), BinKeys{box_, grid_, positions, built_at_, keys_});
  bins_.build(keys_, vertices, grid_.bins());
  FindNeighbours find{box_, grid_, positions, cell_of_vertex_, bins_.begin(), bins_.order(), rows_.begin, rows_.list, parameters_.range + parameters_.skin, false};
  Kokkos::parallel_for("contact_count", Kokkos::RangePolicy<ExecSpace>(0, vertices), find);
  const int total = counts_to_offsets(rows_.begin);
  if (int(rows_.list.extent(0)) < total)
    rows_.list = Array1<int>(Kokkos::view_alloc(Kokkos::WithoutInitializing, "contact_list"), total + total / 4);
  find.list = rows_.list;
  find.write = true;
  Kokkos::parallel_for("contact_fill", Kokkos::RangePolicy<ExecSpace>(0, vertices), find);
}

void Contact::add_forces(const VertexVectors& positions, const VertexVectors& forces) {
  update_lists(positions);
  Kokkos::parallel_for("contact_forces", Kokkos::RangePolicy<ExecSpace>(0, positions.extent(0)),
                       ContactForce{box_, {parameters_.strength, parameters_.range}, positions, forces, rows_});
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
  return (keys_.span() + rows_.begin.span() + rows_.list.span()) * sizeof(int) + built_at_.span() * sizeof(double) + bins_.bytes();
}

}  // namespace corpuscle
