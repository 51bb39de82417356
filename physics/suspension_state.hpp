// What the next time steps of a suspension depend on, on the host: nothing else has to be kept to go on bit for bit. Lists of contacts, forces and whatever
// else a step computes from it are not part of it; random numbers are functions of counters.
#pragma once
#include <cstdint>
#include <functional>
#include <variant>
#include <vector>

namespace corpuscle {

/// What the vertex update remembers (physics/vertex_motion.hpp). Arrays [V][3], empty with `euler` and with coupling_every > 1.
struct VertexMotionState {
  std::int64_t steps = 0;
  std::int64_t stages = 1;                   ///< chebyshev: of the last estimate of the stiffness
  std::vector<double> before, before_that;   ///< u(t-1), u(t-2), lattice units
};

/// All but the populations of the fluid, which are handed over one direction at a time, so that no second copy of the fluid is needed.
struct SuspensionState {
  std::int64_t step = 0;
  std::vector<double> positions, velocities;  ///< [V][3], lattice units, positions unwrapped; empty without cells
  VertexMotionState motion;
};

/// One of the 19 populations before the collision of the coming step at all nodes, [nz][ny][nx], shifted by its weight (kernels/velocity_set.hpp), in the
/// precision of the run. Where it lies in memory depends on the parity of the step and on the backend; this does not.
using Population = std::variant<std::vector<float>, std::vector<double>>;
/// Gives the population of a direction 0 ... 18. Asked in ascending order.
using PopulationSource = std::function<Population(int direction)>;

}  // namespace corpuscle
