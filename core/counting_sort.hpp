// Stable counting sort of many items into few bins, in parallel and with the same result for any number of threads.
#pragma once
#include <string>

#include "core/types.hpp"

namespace corpuscle {

/// order: item numbers grouped by bin, in ascending order inside a bin; bin b is order[begin(b)] ... order[begin(b + 1) - 1].
/// Memory is kept between calls. Host only (the number of chunks is small).
class CountingSort {
 public:
  /// keys [items], each in [0, bins).
  void sort(const Array1<int>& keys, int items, int bins) {
    if (int(order_.extent(0)) < items) order_ = Array1<int>(Kokkos::view_alloc(Kokkos::WithoutInitializing, "sort_order"), items);
    if (int(counts_.extent(0)) < bins * chunks + 1) {
      counts_ = Array1<int>("sort_counts", bins * chunks + 1);
      begin_ = Array1<int>("sort_begin", bins + 1);
    }
    const int per_chunk = (items + chunks - 1) / chunks;
    const auto counts = counts_, begin = begin_, order = order_;
    Kokkos::parallel_for("sort_count", Kokkos::RangePolicy<ExecSpace>(0, chunks), KOKKOS_LAMBDA(const int chunk) {
      for (int bin = 0; bin < bins; ++bin) counts(bin * chunks + chunk) = 0;
      const int last = (chunk + 1) * per_chunk < items ? (chunk + 1) * per_chunk : items;
      for (int i = chunk * per_chunk; i < last; ++i) ++counts(keys(i) * chunks + chunk);
    });
    Kokkos::parallel_for("sort_scan", Kokkos::RangePolicy<ExecSpace>(0, 1), KOKKOS_LAMBDA(const int) {
      int sum = 0;
      for (int bin = 0; bin < bins; ++bin) {
        begin(bin) = sum;
        for (int chunk = 0; chunk < chunks; ++chunk) {
          const int count = counts(bin * chunks + chunk);
          counts(bin * chunks + chunk) = sum;
          sum += count;
        }
      }
      begin(bins) = sum;
    });
    Kokkos::parallel_for("sort_place", Kokkos::RangePolicy<ExecSpace>(0, chunks), KOKKOS_LAMBDA(const int chunk) {
      const int last = (chunk + 1) * per_chunk < items ? (chunk + 1) * per_chunk : items;
      for (int i = chunk * per_chunk; i < last; ++i) order(counts(keys(i) * chunks + chunk)++) = i;
    });
  }
  Array1<int> order() const { return order_; }
  Array1<int> begin() const { return begin_; }
  static std::size_t bytes_of_bins(std::size_t bins) { return (bins * (chunks + 1) + 2) * sizeof(int); }
  std::size_t bytes() const { return (order_.span() + counts_.span() + begin_.span()) * sizeof(int); }

 private:
  static constexpr int chunks = 32;  // fixed: the result must not depend on the number of threads
  Array1<int> order_, counts_, begin_;
};

}  // namespace corpuscle
