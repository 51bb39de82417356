// How fast this machine is: a short measurement, for the predicted time of a run.
#pragma once
#include "physics/problem.hpp"
#include "physics/units.hpp"

namespace corpuscle::app {

/// Seconds of a time step = per_node * nodes; of a coupling more by per_vertex * vertices, of a sample by per_vertex_sampled * vertices.
struct Calibration {
  double per_node = 0;            ///< mean over the steps from one coupling to the next
  double per_vertex = 0;          ///< membranes, contacts with their share of the searches for neighbours, coupling; 0 without cells
  double per_vertex_sampled = 0;
  /// Of a scene like the one that was measured.
  double seconds_per_step(const LatticeParameters& lattice) const;
};
/// Runs small versions of the scene for about a second. Kokkos must be running.
Calibration calibrate(const Problem& problem, const LatticeParameters& lattice);

}  // namespace corpuscle::app
