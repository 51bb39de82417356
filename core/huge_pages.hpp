// Large arrays on huge pages, where the system has them on request: a vertex touches a dozen pages of the lattice, the vertices of a pencil lie on as many as there are, and the
// addresses of all these pages fall out of the caches in a step.
#pragma once
#include <cstdint>
#include <string>

#include "core/types.hpp"

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace corpuscle {

/// A view of zeros; on a Linux host its pages are huge (2 MiB) if transparent huge pages are on "madvise" or "always".
template <class View, class... Extents>
View zeros_on_huge_pages(const std::string& label, const Extents... extents) {
  const View view(Kokkos::view_alloc(label, Kokkos::WithoutInitializing), extents...);
#if defined(__linux__)
  if constexpr (runs_on_host) {
    constexpr std::uintptr_t huge = std::uintptr_t(2) << 20;
    const auto begin = (reinterpret_cast<std::uintptr_t>(view.data()) + huge - 1) / huge * huge;
    const auto end = (reinterpret_cast<std::uintptr_t>(view.data()) + view.span() * sizeof(typename View::value_type)) / huge * huge;
    if (end > begin) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);  // advice: refused is fine
  }
#endif
  Kokkos::deep_copy(view, typename View::value_type(0));
  return view;
}

}  // namespace corpuscle
