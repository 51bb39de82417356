// How much larger than its mesh a cell is for the flow, and meshes that are made smaller by as much (docs/theory/hydrodynamic_radius.md). No Kokkos here.
#pragma once
#include "physics/mesh.hpp"
#include "physics/problem.hpp"

namespace corpuscle {

/// Measured shell in lattice units, a_h - a of a rigid sphere of vertices at the radius a that has the drag of a sphere of radius a_h: that of a plane plus a
/// part that goes with the curvature, `plane + curvature/a` (`./dev bench hydrodynamic_radius`, a = 3 ... 12), for TRT with Lambda = 3/16.
struct KernelShell {
  double plane;      ///< lattice units
  double curvature;  ///< lattice units squared
};
KernelShell kernel_shell(int delta_kernel);

/// The shell of a cell of this nominal radius (lattice units): `accuracy.shell_thickness`, or that of the kernel and the collision around the mesh that
/// `accuracy.cell_size` asks for. With Lambda below 0.04 or above 1 (BGK: tau < 0.7, tau > 1.5), which was not measured, that at the end of the range.
double shell_thickness(const AccuracySpec& accuracy, double radius);

/// The shell that `accuracy.counted_shell` adds to a cell in phi_effective: that of the drag, or of the viscosity, which is thicker by a part of that of a plane. The latter was fitted to suspensions of
/// red cells, 2 and 3 points, r = 4 ... 12, phi_effective = 0.2 and 0.45, Ca = 0.08 (docs/accuracy.md). With `accuracy.shell_thickness`, or meshes that lie a shell inside, there is one shell only.
double counted_shell(const AccuracySpec& accuracy, double radius);

/// The mesh of a scene's cell type at its nominal radius (lattice units), or a shell inside of it with `accuracy.cell_size = "hydrodynamic"`.
/// @throws InputError where the shell is too thick for the shape: a third of the thickness must be left, and no triangle may turn over.
Mesh make_cell_mesh(const CellSpec& spec, const AccuracySpec& accuracy, double radius, int frequency);

/// Moves every vertex inwards by `distance` along the normal of the surface: the parallel surface. May turn triangles over where the surface is curved more tightly.
Mesh inset(const Mesh& mesh, double distance);
/// Shortest chord from a vertex along its inner normal: the least thickness, or about twice the radius of curvature of a sharp rim. O(vertices x faces).
double thinnest(const Mesh& mesh);

}  // namespace corpuscle
