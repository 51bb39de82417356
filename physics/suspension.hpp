// The time step of a suspension of cells, assembled from what the scene contains: from one coupling of membranes and fluid to the next.
#pragma once
#include <memory>

#include "physics/cells.hpp"
#include "physics/fluid.hpp"
#include "physics/problem.hpp"
#include "physics/sample.hpp"
#include "physics/suspension_state.hpp"
#include "physics/units.hpp"

namespace corpuscle {

/// A running simulation. The precision of the fluid is hidden behind this interface.
class Suspension {
 public:
  virtual ~Suspension() = default;

  /// Lets membranes and contacts of a packed start relax, without flow: a packing knows neither the moduli nor the contact force of the scene. Cells move by a
  /// fraction of the contact range. Before the first step only.
  virtual void settle() = 0;
  /// One time step (docs/theory/model.md): F = -dE/dx + contact + external; f = spread F; collide and stream; u = interpolate; x += u.
  /// With accuracy.coupling_every = k it is k time steps of the fluid under the same f: x += k u.
  virtual void step() = 0;
  /// The same, and what was measured at its beginning.
  virtual Sample step_and_measure() = 0;
  /// Positions and velocities of all vertices now.
  virtual Snapshot snapshot(bool with_fluid) const = 0;

  /// What the next steps depend on, but for the populations.
  virtual SuspensionState state() const = 0;
  /// Population of a direction 0 ... 18 in the precision of the fluid.
  virtual Population population(int direction) const = 0;
  /// Goes on from a state of the same scene, bit for bit as the run would have gone on that it was taken of. Populations of the other precision are converted.
  virtual void restore(const SuspensionState& state, const PopulationSource& population) = 0;

  /// The guards (physics/guards.hpp). @throws SimulationError when the state is no longer physical: names step, cell, place, likely cause and what to change.
  virtual void check() = 0;

  /// Momentum of the fluid, summed over the nodes; constant in a periodic box without body force.
  virtual std::array<double, 3> fluid_momentum() const = 0;
  /// Bytes allocated for fields and vertices.
  virtual std::size_t bytes() const = 0;
};

/// The fluid of a scene, as `make_suspension` constructs it.
FluidParameters fluid_parameters(const Problem& problem, const LatticeParameters& lattice);

/// @param positions of all vertices, from `place_cells`; empty without cells
std::unique_ptr<Suspension> make_suspension(const Problem& problem, const LatticeParameters& lattice, std::vector<CellType> types,
                                            const std::vector<double>& positions);

}  // namespace corpuscle
