// Which radius and kernel are worth their time: the measured settings of docs/accuracy.md, with error and cost in a given scene.
#pragma once
#include <optional>
#include <vector>

#include "physics/problem.hpp"
#include "physics/resolution_error.hpp"

namespace corpuscle {

/// A radius and a kernel that were measured for the way in which the scene counts its cells.
struct ResolutionChoice {
  double radius = 0;
  int delta_kernel = 0;
  ResolutionError error;
  double cost = 0;   ///< node updates per unit of strain, vertices counted with what they cost in their place
  double bound = 0;  ///< what the error stays below with this and all finer measured radii of the kernel: a coarse one may be right by accident
};

/// All measured settings of the scene in ascending order of cost, those left out that the scene can't be run with (limits of stability, shells that overfill the box).
/// Its own radius and kernel don't matter. Empty where nothing was measured for such a scene.
std::vector<ResolutionChoice> resolution_choices(const Problem& problem);
/// Those among them that no cheaper one equals in accuracy.
std::vector<ResolutionChoice> worthwhile(const std::vector<ResolutionChoice>& choices);

/// Cost of the scene as it is, in the same unit.
double resolution_cost(const Problem& problem, const LatticeParameters& lattice);

/// Sets radius and delta_kernel to the cheapest measured ones whose error is below `target` (relative: 0.05). `radius` and `delta_kernel`, where given, are kept.
/// Throws InputError, with the best that was measured, when there is none.
void choose_resolution(Problem& problem, double target, std::optional<double> radius, std::optional<int> delta_kernel);

}  // namespace corpuscle
