// The shear rate of a scene, from its capillary number and the limits of accuracy and stability.
#pragma once
#include "physics/units.hpp"

namespace corpuscle {

/// Chooses kappa_S and the shear rate together: the capillary number ties one to the other, every limit bounds both. By default stability is used up to `stability_margin`;
/// values that the scene fixes are refused beyond the measured limits only.
/// Needs viscosity, nodes and cell types in `lattice`; sets its shear rate, capillary number and list of limits.
/// @returns kappa_S of the scene in lattice units; 0 without cells
/// @throws InputError when a key fixes the modulus or the rate beyond a limit
double choose_shear_rate(const Problem& problem, LatticeParameters& lattice);

}  // namespace corpuscle
