// How much larger than its mesh a cell is for the flow, and meshes that are made smaller by as much (docs/theory/hydrodynamic_radius.md). No Kokkos here.
#pragma once
#include "physics/mesh.hpp"
#include "physics/problem.hpp"

namespace corpuscle {

/// Measured shell in lattice units, a_h - a of a rigid sphere of vertices at the radius a that has the drag of a sphere of radius a_h: that of a plane plus a
/// part that goes with the curvature, `plane + curvature/a` (`./dev bench hydrodynamic_radius`, a = 3 ... 12).
struct KernelShell {
  double plane;      ///< lattice units
  double curvature;  ///< lattice units squared
};
KernelShell kernel_shell(int delta_kernel);

/// The shell of a cell of this nominal radius (lattice units): `accuracy.shell_thickness`, or that of the kernel around the mesh that `accuracy.cell_size` asks for.
double shell_thickness(const AccuracySpec& accuracy, double radius);

/// The mesh of a scene's cell type at its nominal radius (lattice units), or a shell inside of it with `accuracy.cell_size = "hydrodynamic"`.
/// @throws InputError where the shell is too thick for the shape: a third of the thickness must be left, and no triangle may turn over.
Mesh make_cell_mesh(const CellSpec& spec, const AccuracySpec& accuracy, double radius, int frequency);

/// Moves every vertex inwards by `distance` along the normal of the surface: the parallel surface. May turn triangles over where the surface is curved more tightly.
Mesh inset(const Mesh& mesh, double distance);
/// Shortest way through the body from a vertex along its inner normal. O(vertices x faces).
double thinnest(const Mesh& mesh);

}  // namespace corpuscle
