#include "physics/coupling.hpp"

#include "kernels/delta_kernel.hpp"
#include "kernels/interpolate.hpp"
#include "kernels/spread.hpp"
#include "kernels/stencil_block.hpp"

namespace corpuscle {
namespace {

template <class F>
void with_delta(int delta_kernel, const F& f) {
  if (delta_kernel == 2)
    f(Delta2{});
  else if (delta_kernel == 3)
    f(Delta3{});
  else
    f(Delta4{});
}

/// The box cut into pencils along x, so thick that a vertex touches its own pencil and the next ones in y and z only. Hundreds of them where slabs in z
/// would be a few: threads find work in thin boxes and where cells cluster.
struct Pencils {
  int thickness_y, thickness_z, halo, count_y, count_z;
  // First nodes run from -halo to n - 1 + halo - (width - 1).
  Pencils(const Grid& grid, int width)
      : thickness_y(2 * width),
        thickness_z(width),
        halo(grid.halo),
        count_y((grid.ny + 2 * halo) / thickness_y + 1),
        count_z((grid.nz + 2 * halo) / thickness_z + 1) {}
  KOKKOS_FORCEINLINE_FUNCTION int of(const int y, const int z) const { return (z + halo) / thickness_z * count_y + (y + halo) / thickness_y; }
  int count() const { return count_y * count_z; }
};

template <class Delta>
struct PencilKeys {
  PeriodicBox box;
  Pencils pencils;
  VertexVectors positions;
  Array1<int> keys;
  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int vertex) const {
    keys(vertex) = pencils.of(first_node<Delta>(box, positions(vertex, 1), 1), first_node<Delta>(box, positions(vertex, 2), 2));
  }
};

/// Spreads all vertices of one pencil, in order. Pencils of one colour (even or odd in y, even or odd in z) have no node in common.
template <class Real, class Delta>
struct SpreadPencil {
  Grid grid;
  PeriodicBox box;
  Pencils pencils;
  VertexVectors positions, forces;
  VectorField<Real> field;
  Array1<int> order, begin;
  int colour_y, colour_z;

  int of_this_colour_y() const { return (pencils.count_y - colour_y + 1) / 2; }
  int of_this_colour_z() const { return (pencils.count_z - colour_z + 1) / 2; }

  CORPUSCLE_FLATTEN void operator()(const int i) const {
    const int per_row = of_this_colour_y();
    const int pencil = (2 * (i / per_row) + colour_z) * pencils.count_y + 2 * (i % per_row) + colour_y;
    const Grid local_grid = grid;
    const double* const position = positions.data();
    const double* const force = forces.data();
    Real* const nodes = field.data();
    const int last = begin(pencil + 1);
    StencilBlock<Real, Delta> stencils;
    // The vertices of a pencil lie all over memory: ask for those of the next block while this one is spread. 24 bytes may lie on two lines.
    const auto prefetch_vertex = [&](const int i) {
      if (i >= last) return;
      const std::size_t at = 3 * std::size_t(order(i));
      for (const double* const vector : {position + at, force + at}) {
        __builtin_prefetch(vector);
        __builtin_prefetch(vector + 2);
      }
    };
    for (int k = 0; k < stencils.size; ++k) prefetch_vertex(begin(pencil) + k);
    for (int first = begin(pencil); first < last; first += stencils.size) {
      const int* const vertices = order.data() + first;
      const int count = last - first < stencils.size ? last - first : stencils.size;
      stencils.template fill<true>(grid, box, position, count, 0, vertices);
      for (int k = 0; k < stencils.ahead && k < count; ++k) stencils.prefetch(k, local_grid, nodes);
      for (int k = 0; k < count; ++k) {
        if (k + stencils.ahead < count) stencils.prefetch(k + stencils.ahead, local_grid, nodes);
        prefetch_vertex(first + k + stencils.size);
        const double* const f = force + 3 * std::size_t(vertices[k]);
        spread_vertex<PlainAdder>(stencils[k], Real(f[0]), Real(f[1]), Real(f[2]), local_grid, nodes);
      }
    }
  }
};

/// Velocities of one block of vertices.
template <class Real, class Delta>
struct InterpolateBlock {
  Grid grid;
  PeriodicBox box;
  VertexVectors positions, velocities;
  VectorField<Real> field;
  static constexpr int size = StencilBlock<Real, Delta>::size;

  CORPUSCLE_FLATTEN void operator()(const int block) const {
    const int first = block * size, vertices = int(positions.extent(0));
    const int count = vertices - first < size ? vertices - first : size;
    const Grid local_grid = grid;
    double* const velocity = velocities.data() + 3 * std::size_t(first);
    const Real* const nodes = field.data();
    StencilBlock<Real, Delta> stencils;
    stencils.template fill<false>(grid, box, positions.data(), count, first, nullptr);
    for (int k = 0; k < stencils.ahead && k < count; ++k) stencils.prefetch(k, local_grid, nodes);
    for (int k = 0; k < count; ++k) {
      if (k + stencils.ahead < count) stencils.prefetch(k + stencils.ahead, local_grid, nodes);
      interpolate_vertex(stencils[k], local_grid, nodes, velocity + 3 * k);
    }
  }
};

}  // namespace

template <class Real>
Coupling<Real>::Coupling(const Grid& grid, bool walls, int delta_kernel, SpreadMode mode)
    : grid_(grid), box_(grid, walls), delta_kernel_(delta_kernel), mode_(mode) {}

template <class Real>
std::size_t Coupling<Real>::predicted_bytes(const Grid& grid, int delta_kernel, std::size_t vertices) {
  if (!runs_on_host) return 0;
  return vertices * 2 * sizeof(int) + CountingSort::bytes_of_bins(Pencils(grid, delta_kernel).count());
}

template <class Real>
template <class Delta>
void Coupling<Real>::spread_coloured(const VertexVectors& positions, const VertexVectors& forces, const VectorField<Real>& field) {
  const int vertices = int(positions.extent(0));
  if (int(keys_.extent(0)) < vertices) keys_ = Array1<int>("spread_keys", vertices);
  const Pencils pencils(grid_, Delta::width);
  Kokkos::parallel_for("spread_keys", Kokkos::RangePolicy<ExecSpace>(0, vertices), PencilKeys<Delta>{box_, pencils, positions, keys_});
  sort_.sort(keys_, vertices, pencils.count());
  for (int colour_z = 0; colour_z < 2; ++colour_z)
    for (int colour_y = 0; colour_y < 2; ++colour_y) {
      const SpreadPencil<Real, Delta> body{grid_, box_, pencils, positions, forces, field, sort_.order(), sort_.begin(), colour_y, colour_z};
      using Policy = Kokkos::RangePolicy<ExecSpace, Kokkos::Schedule<Kokkos::Dynamic>>;
      Kokkos::parallel_for("spread", Policy(0, body.of_this_colour_y() * body.of_this_colour_z()).set_chunk_size(1), body);
    }
}

template <class Real>
void Coupling<Real>::spread(const VertexVectors& positions, const VertexVectors& forces, const VectorField<Real>& field) {
  with_delta(delta_kernel_, [&](auto delta) {
    using Delta = decltype(delta);
    if constexpr (runs_on_host)
      if (mode_ == SpreadMode::coloured) return spread_coloured<Delta>(positions, forces, field);
    Kokkos::parallel_for("spread", Kokkos::RangePolicy<ExecSpace>(0, positions.extent(0)), Spread<Real, Delta>{grid_, box_, positions, forces, field});
  });
}

template <class Real>
void Coupling<Real>::interpolate(const VertexVectors& positions, const VertexVectors& velocities, const VectorField<Real>& field) const {
  with_delta(delta_kernel_, [&](auto delta) {
    using Delta = decltype(delta);
    const int vertices = int(positions.extent(0));
    if constexpr (runs_on_host) {
      const InterpolateBlock<Real, Delta> body{grid_, box_, positions, velocities, field};
      Kokkos::parallel_for("interpolate", Kokkos::RangePolicy<ExecSpace>(0, (vertices + body.size - 1) / body.size), body);
    } else {
      Kokkos::parallel_for("interpolate", Kokkos::RangePolicy<ExecSpace>(0, vertices), Interpolate<Real, Delta>{grid_, box_, positions, velocities, field});
    }
  });
}

template class Coupling<float>;
template class Coupling<double>;

}  // namespace corpuscle
