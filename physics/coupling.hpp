// Immersed boundary coupling between vertices and fluid: spread, interpolate (docs/theory/model.md, Coupling).
#pragma once
#include "core/counting_sort.hpp"
#include "kernels/stencil.hpp"
#include "physics/fluid.hpp"

namespace corpuscle {

/// How `spread` avoids that two threads add to the same node.
enum class SpreadMode {
  coloured,  ///< host: pencils along x in four colours, one colour at a time; the sum is the same for any number of threads
  atomic     ///< devices
};

template <class Real>
class Coupling {
 public:
  /// delta_kernel: 2, 3 or 4 points. The fluid's halo must be at least `halo_width(delta_kernel)`.
  Coupling(const Grid& grid, bool walls, int delta_kernel, SpreadMode mode = runs_on_host ? SpreadMode::coloured : SpreadMode::atomic);

  /// Adds the vertices' forces to the field including its halo; `Fluid::scatter_force` brings the halo home.
  void spread(const VertexVectors& positions, const VertexVectors& forces, const VectorField<Real>& field);
  /// velocities = field at the positions; the field's halo must be current (`Fluid::gather_velocity`).
  void interpolate(const VertexVectors& positions, const VertexVectors& velocities, const VectorField<Real>& field) const;

  static int halo_width(int delta_kernel) { return delta_kernel == 4 ? 2 : 1; }
  /// What `spread` will have allocated for so many vertices.
  static std::size_t predicted_bytes(const Grid& grid, int delta_kernel, std::size_t vertices);
  std::size_t bytes() const { return keys_.span() * sizeof(int) + sort_.bytes(); }

 private:
  template <class Delta>
  void spread_coloured(const VertexVectors& positions, const VertexVectors& forces, const VectorField<Real>& field);

  Grid grid_;
  PeriodicBox box_;
  int delta_kernel_;
  SpreadMode mode_;
  Array1<int> keys_;
  CountingSort sort_;
};

}  // namespace corpuscle
