// Vertex vectors from plain host arrays; back by `to_host`.
#pragma once
#include <string>
#include <vector>

#include "core/huge_pages.hpp"
#include "core/to_host.hpp"
#include "core/types.hpp"

namespace corpuscle {

/// [V][3] from 3 V numbers, x y z of one vertex after the other.
inline VertexVectors to_device(const std::vector<double>& host, const std::string& label = "vertex_vectors") {
  const auto vectors = zeros_on_huge_pages<VertexVectors>(label, host.size() / 3);
  Kokkos::deep_copy(vectors, Kokkos::View<const double* [3], Kokkos::LayoutRight, Kokkos::HostSpace>(host.data(), vectors.extent(0)));
  return vectors;
}

}  // namespace corpuscle
