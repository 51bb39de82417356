// How vertices follow the fluid: the time integration of all cells (docs/theory/model.md, Vertex update).
#pragma once
#include <functional>

#include "core/types.hpp"
#include "kernels/surface_mobility.hpp"
#include "physics/cells.hpp"
#include "physics/chebyshev.hpp"
#include "physics/problem.hpp"
#include "physics/suspension_state.hpp"

namespace corpuscle {

/// Computes forces = -dE/dx of membranes and contacts at the given positions; [V][3], lattice units.
using ForceOperator = std::function<void(const VertexVectors& positions, const VertexVectors& forces)>;

/// The chebyshev update's model of the mobility, M = m (1 - s L)^2 (kernels/surface_mobility.hpp). Lattice units.
struct MobilityModel {
  double mobility;   ///< m, several times the velocity of a sheet in the step after a unit force on each of its vertices: then whatever the membrane resists, the fluid damps
  double smoothing;  ///< s times the largest degree of the mesh. 0.6 leaves a tenth of a zigzag on a regular mesh, as the largest eigenvalue of L is 9 there
};
MobilityModel mobility_model(const std::vector<CellType>& types, int delta_kernel);

/// Moves vertices by one time step with the velocity w that the fluid has at their places; or by several at once, the interval between two couplings. Then the fluid's velocity is a mean over
/// two steps already (Fluid::collide_stream_holding_force) and w = u with every update.
/// - euler: w = u(t).
/// - averaged: w = (3 u(t) + 2 u(t-1) - u(t-2))/4. The lattice has staggered momenta that flip sign at every step and that no collision damps (Zanetti, Phys. Rev. A 40,
///   1539 (1989)). The 2- and 3-point kernels see them, and an elastic membrane that follows them feeds them. This mean is blind to them, and its delay is zero, so that it feeds
///   no oscillation either.
/// - chebyshev: the same w, and during the step the membranes relax: dx/ds = w + M [F(x(s)) - F(x(0))], s = 0 ... 1, by as many Chebyshev stages as the stiffness asks for. M
///   stands for the mobility in the first step after a kick (kernels/surface_mobility.hpp). Exact where the forces do not change (rigid motion, steady states), of first order else.
///   No stiffness is unstable; the cost of a step grows with its square root.
class VertexMotion {
 public:
  /// @param mobility for chebyshev, of one step
  /// @param interval time steps from one call to the next
  VertexMotion(const std::vector<CellType>& types, VertexUpdate update, const MobilityModel& mobility, int interval = 1);

  /// Where the velocity of the motion from x(t) on is to be taken: at x(t), or halfway between two couplings, x(t) + (interval/2) u(t - interval). Without that each coupling
  /// would move a turning cell outwards along the tangent, by the square of the angle.
  VertexVectors halfway(const VertexVectors& positions, const VertexVectors& velocities_before);
  /// x(t) -> x(t + interval). `forces` must hold F(x(t)); it is overwritten (chebyshev).
  void advance(const VertexVectors& positions, const VertexVectors& velocities, const VertexVectors& forces, const ForceOperator& compute_forces);

  /// Chebyshev stages of the last step; 1 for the other updates.
  int stages() const { return 1 + int(scheme_.stages.size()); }
  VertexMotionState state() const;
  /// Goes on from a state of the same update and the same vertices.
  void restore(const VertexMotionState& state);

  std::size_t bytes() const;
  /// What `bytes` will be, but for the tables of the types.
  static std::size_t bytes_per_vertex(VertexUpdate update, int interval);
  /// Whether the velocities of earlier steps are kept.
  static bool keeps_velocities(VertexUpdate update, int interval) { return update != VertexUpdate::euler && interval == 1; }

 private:
  VertexUpdate update_;
  int interval_;
  std::vector<SurfaceMobility> mobilities_;      // chebyshev, one a type
  ChebyshevScheme scheme_{1};                    // chebyshev, of the last estimate of the stiffness
  long steps_ = 0;
  VertexVectors before_, before_that_;           // u(t-1), u(t-2)
  VertexVectors halfway_;                        // interval > 1
  VertexVectors drift_, start_forces_, last_, smoothed_;  // chebyshev: w, F(x(0)), the stage before the present one
};

/// Follows the forces downhill for `rounds` units of time without any fluid: takes the strong local forces out of a packed state. `forces` is scratch.
void settle(const std::vector<CellType>& types, const MobilityModel& mobility, int rounds, const VertexVectors& positions, const VertexVectors& forces, const ForceOperator& compute_forces);

}  // namespace corpuscle
