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

}  // namespace corpuscle
