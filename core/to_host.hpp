// Output's way from the device to plain host arrays.
#pragma once
#include <algorithm>
#include <cstring>
#include <vector>

#include "core/types.hpp"

namespace corpuscle {

/// Page-locked host memory, which devices copy to at the full speed of the bus (pageable memory gets about half); plain host memory
/// where kernels run on the host.
using StagingSpace = Kokkos::SharedHostPinnedSpace;

namespace detail {
/// `count` numbers through a staging buffer of `part` numbers: one part after the other, so that page-locked memory, which the system cannot swap, stays small.
template <class T, class Space>
void copy_in_parts(const T* from, std::size_t count, T* to, std::size_t part) {
  if (count == 0) return;
  const Kokkos::View<T*, Kokkos::LayoutRight, StagingSpace> buffer(Kokkos::view_alloc(Kokkos::WithoutInitializing, "staging"), std::min(count, part));
  for (std::size_t first = 0; first < count; first += part) {
    const std::size_t n = std::min(part, count - first);
    const Kokkos::View<const T*, Kokkos::LayoutRight, Space, Kokkos::MemoryTraits<Kokkos::Unmanaged>> source(from + first, n);
    const Kokkos::View<T*, Kokkos::LayoutRight, StagingSpace, Kokkos::MemoryTraits<Kokkos::Unmanaged>> staged(buffer.data(), n);
    Kokkos::deep_copy(staged, source);
    std::memcpy(to + first, buffer.data(), n * sizeof(T));
  }
}
}  // namespace detail

/// All numbers of a contiguous view, in the order of its memory.
template <class View>
std::vector<typename View::non_const_value_type> to_host(const View& view) {
  using T = typename View::non_const_value_type;
  constexpr std::size_t staging_bytes = std::size_t(16) << 20;
  std::vector<T> host(view.span());
  if constexpr (runs_on_host) {
    Kokkos::fence("to_host");
    if (!host.empty()) std::memcpy(host.data(), view.data(), host.size() * sizeof(T));
  } else {
    detail::copy_in_parts<T, typename View::memory_space>(view.data(), host.size(), host.data(), staging_bytes / sizeof(T));
  }
  return host;
}

}  // namespace corpuscle
