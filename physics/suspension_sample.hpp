// Averages over cells: from per-cell samples to the stress, viscosity and shape of the suspension. Host only, so that files can be analysed with it as well.
#pragma once
#include "physics/cells.hpp"
#include "physics/sample.hpp"

namespace corpuscle {

/// Fills everything of `sample` that follows from `sample.cells`: stresses, viscosities, normal stress differences, drifts, mean deformation.
/// @param types as in `lattice.cells`, made from them
/// @param walls whether the bulk excludes a layer of 4 r at z = 0 and z = L_z
void average_over_cells(Sample& sample, const std::vector<CellType>& types, const LatticeParameters& lattice, bool walls);

}  // namespace corpuscle
