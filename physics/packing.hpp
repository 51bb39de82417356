// Initial positions of all cells: random placement, growth with contact forces up to dense packings (no fluid).
#pragma once
#include <functional>

#include "physics/cells.hpp"
#include "physics/overlap.hpp"
#include "physics/problem.hpp"

namespace corpuscle {

/// Told after every round: scale of the cells in [0, 1], the smallest gap (lattice units) and the number of rounds so far. Return false to stop.
using PackingProgress = std::function<bool(double scale, double gap, int rounds)>;

/// Vertices of all cells, ordered as in `Cells`. Cells with a position in the scene are put there; a single cell without one goes to the centre of
/// the box; all others start as small cells at random places with random orientations and grow, pushed apart by the contact forces and held in shape by
/// their membranes, until they have full size and no overlap. Deterministic: the same scene gives the same positions for any number of threads.
/// @throws InputError when the cells do not fit (names the volume fraction and what to change).
std::vector<double> place_cells(const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types,
                                const PackingProgress& progress = {});

/// Which cells pierce each other or a wall at these positions.
OverlapReport overlap_of(const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types, const std::vector<double>& positions);

/// Whether `place_cells` packs: more than one cell, and none has a position in the scene. The suspension should settle such a start.
bool packs_cells(const Problem& problem, const std::vector<CellType>& types);

/// Reach of the contact lists while cells are packed, lattice units.
double packing_reach(const LatticeParameters& lattice);

}  // namespace corpuscle
