// What kernels need of a mesh.
#pragma once
#include "core/types.hpp"
#include "physics/mesh.hpp"

namespace corpuscle {

/// Triangles [F][3].
using FaceTable = Kokkos::View<int* [3], Kokkos::LayoutRight, MemSpace>;

inline FaceTable faces_on_device(const Mesh& mesh) {
  FaceTable faces("faces", mesh.faces.size());
  const auto host = Kokkos::create_mirror_view(faces);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (int k = 0; k < 3; ++k) host(f, k) = mesh.faces[f][k];
  Kokkos::deep_copy(faces, host);
  return faces;
}

/// Neighbours of every vertex: [V][max degree]; entries beyond a vertex's degree are 0.
inline Array2<int> ring_on_device(const OneRing& ring, const std::string& label) {
  const Array2<int> rows(label, ring.vertex_count, ring.max_degree);
  const auto host = Kokkos::create_mirror_view(rows);
  for (int v = 0; v < ring.vertex_count; ++v)
    for (int i = 0; i < ring.degree[v]; ++i) host(v, i) = ring.neighbour[v * ring.max_degree + i];
  Kokkos::deep_copy(rows, host);
  return rows;
}

inline Array1<int> degrees_on_device(const OneRing& ring, const std::string& label) {
  const Array1<int> degrees(label, ring.vertex_count);
  Kokkos::deep_copy(degrees, Kokkos::View<const int*, Kokkos::LayoutRight, Kokkos::HostSpace>(ring.degree.data(), ring.vertex_count));
  return degrees;
}

}  // namespace corpuscle
