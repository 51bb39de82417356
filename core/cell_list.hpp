// Points sorted into the cells of a coarse periodic grid: neighbours within one cell edge are found in the 27 cells around a point, in O(N).
#pragma once
#include <algorithm>
#include <cmath>

#include "core/types.hpp"

namespace corpuscle {

/// Layout of the bins. Bins are at least `edge` long in each direction.
struct BinGrid {
  int count[3];
  double inverse_edge[3];

  BinGrid() = default;
  /// @param length box lengths; at most `max_bins` bins (fewer, larger ones where the box is huge)
  BinGrid(const double (&length)[3], double edge, int max_bins = 1 << 28) {
    double total = 1;
    for (int k = 0; k < 3; ++k) {
      count[k] = std::max(1, int(length[k] / edge));
      total *= count[k];
    }
    const double shrink = total > max_bins ? std::cbrt(max_bins / total) : 1;
    for (int k = 0; k < 3; ++k) {
      count[k] = std::max(1, int(count[k] * shrink));
      inverse_edge[k] = count[k] / length[k];
    }
  }
  KOKKOS_FORCEINLINE_FUNCTION int coordinate(const double x, const int axis) const {
    const int i = static_cast<int>(x * inverse_edge[axis]);
    return i < 0 ? 0 : i < count[axis] ? i : count[axis] - 1;
  }
  KOKKOS_FORCEINLINE_FUNCTION int bin(const int x, const int y, const int z) const { return (z * count[1] + y) * count[0] + x; }
  int bins() const { return count[0] * count[1] * count[2]; }
};

/// Bin b holds the points order(begin(b)) ... order(begin(b + 1) - 1), in ascending order whatever the number of threads.
class CellList {
 public:
  /// keys [points]: the bin of each point.
  void build(const Array1<int>& keys, int points, int bins) {
    if (int(begin_.extent(0)) < bins + 1) {
      begin_ = Array1<int>("bin_begin", bins + 1);
      fill_ = Array1<int>("bin_fill", bins + 1);
    }
    if (int(order_.extent(0)) < points) order_ = Array1<int>("bin_order", points);
    const auto begin = begin_, fill = fill_, order = order_;
    Kokkos::deep_copy(fill, 0);
    Kokkos::parallel_for("bin_count", Kokkos::RangePolicy<ExecSpace>(0, points), KOKKOS_LAMBDA(const int i) { Kokkos::atomic_inc(&fill(keys(i))); });
    Kokkos::parallel_scan("bin_scan", Kokkos::RangePolicy<ExecSpace>(0, bins + 1), KOKKOS_LAMBDA(const int b, int& sum, const bool final) {
      const int count = fill(b);
      if (final) {
        begin(b) = sum;
        fill(b) = sum;
      }
      sum += count;
    });
    Kokkos::parallel_for("bin_fill", Kokkos::RangePolicy<ExecSpace>(0, points),
                         KOKKOS_LAMBDA(const int i) { order(Kokkos::atomic_fetch_inc(&fill(keys(i)))) = i; });
    // Threads fill a bin in any order; a few items each, so sorting them by insertion is cheap and makes the order unique.
    Kokkos::parallel_for("bin_sort", Kokkos::RangePolicy<ExecSpace>(0, bins), KOKKOS_LAMBDA(const int b) {
      for (int i = begin(b) + 1; i < begin(b + 1); ++i) {
        const int item = order(i);
        int j = i;
        for (; j > begin(b) && order(j - 1) > item; --j) order(j) = order(j - 1);
        order(j) = item;
      }
    });
  }
  Array1<int> begin() const { return begin_; }
  Array1<int> order() const { return order_; }
  std::size_t bytes() const { return (begin_.span() + fill_.span() + order_.span()) * sizeof(int); }

 private:
  Array1<int> begin_, fill_, order_;
};

}  // namespace corpuscle
