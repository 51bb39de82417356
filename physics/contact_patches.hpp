// Where a stretched cell is held: two contact patches on its reference shape. On the host, no Kokkos.
#pragma once
#include <vector>

#include "physics/mesh.hpp"

namespace corpuscle {

/// Vertices (of one cell) that are pulled along the direction, and against it.
struct ContactPatches {
  std::vector<int> ahead, behind;
  double smallest_diameter;  ///< for which both patches hold a vertex
  double largest_diameter;   ///< above it the patches overlap
};

/// The vertices within diameter/2 of the two points where the line through the centroid leaves the reference shape for good.
/// @param direction of the line in the frame of the mesh; any length but 0
ContactPatches contact_patches(const Mesh& reference, const Vector3& direction, double diameter);

/// Direction of a scene's stretching in the frame of the reference shape, which `axis` turns when the cell is placed.
Vector3 direction_in_reference(const CellSpec& spec);

}  // namespace corpuscle
