// Averages over cells: from per-cell samples to the stress, viscosity and shape of the suspension. Host only, so that files can be analysed with it as well.
#pragma once
#include "physics/cells.hpp"
#include "physics/sample.hpp"

namespace corpuscle {

/// Thickness of the layers at the walls that are no bulk: 4 r; 0 where no bulk would be left, and without walls.
inline double wall_layer(const LatticeParameters& lattice, bool walls) { return walls && lattice.nodes[2] > 8 * lattice.radius ? 4 * lattice.radius : 0; }

/// Fills everything of `sample` that follows from `sample.cells`: stresses, viscosities, normal stress differences, drifts, mean deformation.
/// @param types as in `lattice.cells`, made from them
/// @param walls whether the bulk excludes a layer of 4 r at z = 0 and z = L_z
void average_over_cells(Sample& sample, const std::vector<CellType>& types, const LatticeParameters& lattice, bool walls);

}  // namespace corpuscle
