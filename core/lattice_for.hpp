// The only loops over lattice nodes. Host: threads over (z, y) rows, the compiler vectorises along x (3-6x over flat policies, docs/performance.md);
// devices: one thread a node.
#pragma once
#include <cstdint>
#include <string>
#include <type_traits>

#include "core/flatten.hpp"
#include "core/grid.hpp"
#include "core/types.hpp"

namespace corpuscle {

/// Half-open ranges of node coordinates; may reach into the halo.
struct LatticeBox {
  int x0, x1, y0, y1, z0, z1;
  KOKKOS_FORCEINLINE_FUNCTION int length() const { return x1 - x0; }
  KOKKOS_FORCEINLINE_FUNCTION int rows() const { return (y1 - y0) * (z1 - z0); }
};
inline LatticeBox interior(const Grid& grid) { return {0, grid.nx, 0, grid.ny, 0, grid.nz}; }

/// Whether nodes come in whole rows along x, so that bodies with `enter_row` and `leave_row` get them called.
constexpr bool loops_over_rows = runs_on_host;

namespace detail {
template <class Body>
struct HostRows {
  Grid grid;
  LatticeBox box;
  Body body;
  CORPUSCLE_FLATTEN void operator()(const int row) const {
    const int y = box.y0 + row % (box.y1 - box.y0);
    const int z = box.z0 + row / (box.y1 - box.y0);
    const int begin = grid.index(box.x0, y, z);
    const int length = box.length();
    const Body local = body;  // a local copy lets the compiler keep pointers in registers
    if constexpr (requires { local.enter_row(begin, length); }) local.enter_row(begin, length);
    if constexpr (std::is_invocable_v<const Body&, int>) {
#pragma omp simd
      for (int i = 0; i < length; ++i) local(begin + i);
    } else {
      for (int i = 0; i < length; ++i) local(begin + i, box.x0 + i, y, z);
    }
    if constexpr (requires { local.leave_row(begin, length); }) local.leave_row(begin, length);
  }
};

template <class Body>
struct HostRowCounts {
  Grid grid;
  LatticeBox box;
  Body body;
  CORPUSCLE_FLATTEN void operator()(const int row, std::int64_t& total) const {
    const int begin = grid.index(box.x0, box.y0 + row % (box.y1 - box.y0), box.z0 + row / (box.y1 - box.y0));
    const int length = box.length();
    const Body local = body;
    int found = 0;
#pragma omp simd reduction(+ : found)
    for (int i = 0; i < length; ++i) found += local(begin + i);
    total += found;
  }
};

template <class Body>
struct DeviceCounts {
  Grid grid;
  LatticeBox box;
  Body body;
  KOKKOS_FUNCTION void operator()(const int flat, std::int64_t& total) const {
    const int row = flat / box.length();
    total += body(grid.index(box.x0 + flat % box.length(), box.y0 + row % (box.y1 - box.y0), box.z0 + row / (box.y1 - box.y0)));
  }
};

template <class Body>
struct DeviceNodes {
  Grid grid;
  LatticeBox box;
  Body body;
  KOKKOS_FUNCTION void operator()(const int flat) const {
    const int row = flat / box.length();
    const int x = box.x0 + flat % box.length();
    const int y = box.y0 + row % (box.y1 - box.y0);
    const int z = box.z0 + row / (box.y1 - box.y0);
    if constexpr (std::is_invocable_v<const Body&, int>)
      body(grid.index(x, y, z));
    else
      body(grid.index(x, y, z), x, y, z);
  }
};

template <class Body>
struct RowSums {
  Grid grid;
  LatticeBox box;
  Body body;
  Array1<double> sums;
  KOKKOS_FUNCTION void operator()(const int row) const {
    const int y = box.y0 + row % (box.y1 - box.y0);
    const int z = box.z0 + row / (box.y1 - box.y0);
    double sum = 0;
    for (int x = box.x0; x < box.x1; ++x) sum += body(grid.index(x, y, z), x, y, z);
    sums(row) = sum;
  }
};
}  // namespace detail

/// Calls body(node) or body(node, x, y, z) for every node of the box, in any order. Bodies must be force-inlined functors and
/// touch each memory location from one node only; body(node) is vectorised on the host and must not branch. Where `loops_over_rows`,
/// body.enter_row(first node, length) and body.leave_row(...) are called before and after the nodes of each row, if the body has them.
template <class Body>
void lattice_for(const std::string& label, const Grid& grid, const LatticeBox& box, const Body& body) {
  if (box.rows() <= 0 || box.length() <= 0) return;
  if constexpr (runs_on_host)
    Kokkos::parallel_for(label, Kokkos::RangePolicy<ExecSpace, Kokkos::IndexType<int>>(0, box.rows()),
                         detail::HostRows<Body>{grid, box, body});
  else
    Kokkos::parallel_for(label, Kokkos::RangePolicy<ExecSpace, Kokkos::IndexType<int>>(0, box.rows() * box.length()),
                         detail::DeviceNodes<Body>{grid, box, body});
}

/// A number that kernels leave on the device.
using DeviceCount = Kokkos::View<std::int64_t, MemSpace>;

/// Sum of the integers body(node) over the box. It stays in the memory of the device and is not waited for; bodies as in lattice_for.
template <class Body>
void lattice_count(const std::string& label, const Grid& grid, const LatticeBox& box, const Body& body, const DeviceCount& total) {
  if constexpr (runs_on_host)
    Kokkos::parallel_reduce(label, Kokkos::RangePolicy<ExecSpace, Kokkos::IndexType<int>>(0, box.rows()),
                            detail::HostRowCounts<Body>{grid, box, body}, total);
  else
    Kokkos::parallel_reduce(label, Kokkos::RangePolicy<ExecSpace, Kokkos::IndexType<int>>(0, box.rows() * box.length()),
                            detail::DeviceCounts<Body>{grid, box, body}, total);
}

/// Sum of body(node, x, y, z) over the box, the same bits for any number of threads: rows first, then the rows in order.
template <class Body>
double lattice_sum(const std::string& label, const Grid& grid, const LatticeBox& box, const Body& body) {
  if (box.rows() <= 0 || box.length() <= 0) return 0;
  Array1<double> sums(Kokkos::view_alloc(Kokkos::WithoutInitializing, label), box.rows());
  Kokkos::parallel_for(label, Kokkos::RangePolicy<ExecSpace, Kokkos::IndexType<int>>(0, box.rows()),
                       detail::RowSums<Body>{grid, box, body, sums});
  const auto sums_host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, sums);
  double total = 0;
  for (int row = 0; row < box.rows(); ++row) total += sums_host(row);
  return total;
}

}  // namespace corpuscle
