// Is a set of lattice parameters stable? Small simulations whose step-to-step velocity noise is watched for growth (docs/stability.md).
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "physics/cells.hpp"
#include "physics/problem.hpp"
#include "physics/units.hpp"

namespace corpuscle {

/// What a probe found. The jitter is the root mean square over the vertices of |u(t) - u(t-1)|, the change of a vertex's velocity in one step: tiny for
/// resolved motion (gamma_dot u), of the order of u for what a time step can't resolve. Numerical instabilities show there long before anything breaks.
struct StabilityVerdict {
  bool stable = false;
  double growth_rate = 0;   ///< of the jitter, per coupling, over the last half of the probe; negative: it decays
  double jitter = 0;        ///< at the end; lattice units, or relative to gamma_dot r where the scene is sheared
  std::int64_t steps = 0;   ///< couplings done, time steps unless accuracy.coupling_every > 1; less than asked for where the verdict was clear before
  std::string reason;       ///< in words
};

struct ProbeLength {
  std::int64_t steps = 3000;  ///< couplings: long enough to see the slowest growth that matters: rates above about 2/steps are found
  int windows = 12;           ///< the jitter is averaged over each; growth is judged from one to the next
};

/// Displaces every vertex by a random vector, each component uniform in [-length, length].
void displace(std::vector<double>& positions, double length, std::uint64_t seed);

/// Linear stability of the coupled scheme: a fluid at rest and cells with all vertices displaced by 1e-3. Unstable when the jitter grows over the last half of
/// the probe, a velocity exceeds the run's guard, or the elastic energy of the first cell ends above where it began.
StabilityVerdict probe_at_rest(const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types, std::vector<double> positions,
                               const ProbeLength& length = {});

/// Stability in flow, from positions that are packed already. Unstable when the jitter grows from the first to the second half and exceeds what resolved motion
/// explains, when it exceeds gamma_dot r, or when a guard of the run trips.
StabilityVerdict probe_in_flow(const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types, const std::vector<double>& positions,
                               const ProbeLength& length = {});

}  // namespace corpuscle
