// Per-cell observables: centre, velocity, shape, volume, area, stresslet (docs/theory/model.md, Stress and statistics).
#pragma once
#include <vector>

#include "physics/cells.hpp"
#include "physics/contact.hpp"
#include "physics/mesh_device.hpp"
#include "physics/sample.hpp"

namespace corpuscle {

class CellSampler {
 public:
  CellSampler(const Cells& cells, const PeriodicBox& box);

  /// Stresslet of the membrane, - sum_v F_a (x_b - x0_b). Call when `cells.forces()` holds membrane forces only; they sum to zero, so that the origin does not matter.
  void measure_membrane_stress(const Cells& cells);
  /// Adds half of each pair repulsion, - 1/2 F_a d_b with the nearest-image vector d, and the normal force of the walls.
  void measure_contact_stress(const Cells& cells, const Contact& contact);
  /// Centre, velocity, gyration, volume, area, extent at the present positions and velocities.
  void measure_shape(const Cells& cells);
  /// Result on the host, ordered by type, then number.
  std::vector<CellSample> collect() const;
  std::size_t bytes() const {
    std::size_t total = values_.span() * sizeof(double);
    for (const auto& faces : faces_) total += faces.span() * sizeof(int);
    return total;
  }

 private:
  PeriodicBox box_;
  std::vector<FaceTable> faces_;  // by type
  Kokkos::View<double* [26], Kokkos::LayoutRight, MemSpace> values_;          // centre 3, velocity 3, gyration 6, stresslet 9, volume, area, extent 3
};

}  // namespace corpuscle
