#include "physics/coupling.hpp"

#include "kernels/delta_kernel.hpp"
#include "kernels/interpolate.hpp"
#include "kernels/spread.hpp"

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

/// Slab of a vertex: `width` planes thick, so that a vertex touches its own slab and the next one only.
template <class Delta>
struct SlabKeys {
  PeriodicBox box;
  int halo;
  VertexVectors positions;
  Array1<int> keys;
  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int vertex) const {
    keys(vertex) = (first_plane<Delta>(box, positions(vertex, 2)) + halo) / Delta::width;
  }
};

/// Spreads all vertices of one slab, in order.
template <class Real, class Delta>
struct SpreadSlab {
  Spread<Real, Delta, PlainAdder> spread;
  Array1<int> order, begin;
  int colour;
  KOKKOS_FUNCTION void operator()(const int pair) const {
    const int slab = 2 * pair + colour;
    const auto local = spread;
    const int last = begin(slab + 1);
    for (int i = begin(slab); i < last; ++i) local(order(i));
  }
};

}  // namespace

template <class Real>
Coupling<Real>::Coupling(const Grid& grid, bool walls, int delta_kernel, SpreadMode mode)
    : grid_(grid), box_(grid, walls), delta_kernel_(delta_kernel), mode_(mode) {}

template <class Real>
template <class Delta>
void Coupling<Real>::spread_coloured(const VertexVectors& positions, const VertexVectors& forces, const VectorField<Real>& field) {
  const int vertices = int(positions.extent(0));
  if (int(keys_.extent(0)) < vertices) keys_ = Array1<int>("slab_keys", vertices);
  // First planes run from -halo to nz - 1 + halo - (width - 1) < nz + halo.
  const int slabs = (grid_.nz + 2 * grid_.halo) / Delta::width + 1;
  Kokkos::parallel_for("spread_keys", Kokkos::RangePolicy<ExecSpace>(0, vertices), SlabKeys<Delta>{box_, grid_.halo, positions, keys_});
  sort_.sort(keys_, vertices, slabs);
  const Spread<Real, Delta, PlainAdder> body{grid_, box_, positions, forces, field};
  for (int colour = 0; colour < 2; ++colour)
    Kokkos::parallel_for("spread",
                         Kokkos::RangePolicy<ExecSpace, Kokkos::Schedule<Kokkos::Dynamic>>(0, (slabs - colour + 1) / 2)
                             .set_chunk_size(1),
                         SpreadSlab<Real, Delta>{body, sort_.order(), sort_.begin(), colour});
}

template <class Real>
void Coupling<Real>::spread(const VertexVectors& positions, const VertexVectors& forces, const VectorField<Real>& field) {
  with_delta(delta_kernel_, [&](auto delta) {
    using Delta = decltype(delta);
    if constexpr (runs_on_host)
      if (mode_ == SpreadMode::coloured) return spread_coloured<Delta>(positions, forces, field);
    Kokkos::parallel_for("spread", Kokkos::RangePolicy<ExecSpace>(0, positions.extent(0)),
                         Spread<Real, Delta, AtomicAdder>{grid_, box_, positions, forces, field});
  });
}

template <class Real>
void Coupling<Real>::interpolate(const VertexVectors& positions, const VertexVectors& velocities, const VectorField<Real>& field) const {
  with_delta(delta_kernel_, [&](auto delta) {
    Kokkos::parallel_for("interpolate", Kokkos::RangePolicy<ExecSpace>(0, positions.extent(0)),
                         Interpolate<Real, decltype(delta)>{grid_, box_, positions, velocities, field});
  });
}

template class Coupling<float>;
template class Coupling<double>;

}  // namespace corpuscle
