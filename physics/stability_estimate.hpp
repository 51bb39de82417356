// Linear estimate of the explicit coupling's stability limit: the largest eigenvalue of membrane stiffness times mobility in one step (docs/stability.md).
#pragma once
#include <vector>

#include "physics/cells.hpp"
#include "physics/problem.hpp"
#include "physics/units.hpp"

namespace corpuscle {

/// lambda_max(M K): K = -dF/dx is the Hessian of the elastic energy at the given positions (all moduli in `types`), M = J S the velocity that a unit impulse on a
/// vertex gives to the vertices around it through spreading S and interpolation J, with the mass of the fluid in the kernels as inertia (rho = 1).
/// A membrane mode with eigenvalue lambda is an oscillator of frequency sqrt(lambda) per step, damped by viscosity. A force that is late by theta steps feeds it at the rate
/// lambda theta/2, so the scheme is stable for about lambda < d/theta with the decay d = nu k^2 of momentum at the scale of the kernel (docs/stability.md).
/// Power iteration on the real operators. Double precision, without contact.
double largest_response(const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types, const std::vector<double>& positions);

}  // namespace corpuscle
