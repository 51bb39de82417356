// What is read from and written to the populations between steps: initial states, macroscopic fields, guards, checkpoints.
#pragma once
#include "kernels/collision.hpp"
#include "kernels/streaming.hpp"

namespace corpuscle {

template <class Storage, class Compute>
struct SetPopulations {
  StreamingAccessor<Storage, Compute, 0> populations;
  Kokkos::View<double* [3], Kokkos::LayoutRight, MemSpace> velocity;  // empty: the plane flow between the walls
  int nx, ny, nz;
  double lower, shear_rate, relaxation_time;
  double curvature;   // force/(2 viscosity) of the parabola
  double half_force;  // the populations carry u - F/2
  KOKKOS_FORCEINLINE_FUNCTION void leave_row(const int first, const int length) const { populations.template wrap_row<false>(first, length); }
  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int node, const int x, const int y, const int z) const {
    const double height = z + 0.5;
    Macroscopic<double> m{0, {lower + shear_rate * height + curvature * height * (nz - height), 0, 0}};
    const double gradient = shear_rate + curvature * (nz - 2 * height);
    if (velocity.extent(0) > 0) {
      const int flat = (z * ny + y) * nx + x;
      for (int k = 0; k < 3; ++k) m.u[k] = velocity(flat, k);
    }
    m.u[0] -= half_force;
    double exact[19];
    equilibrium_with_shear(exact, m, velocity.extent(0) > 0 ? 0.0 : gradient, relaxation_time);
    Compute g[19];
    for (int q = 0; q < 19; ++q) g[q] = static_cast<Compute>(exact[q]);
    populations.set(node, g);
  }
};

/// Moments of the present populations; what: 0 density, 1..3 momentum.
template <class Storage, int Parity>
struct NodeMoment {
  StreamingAccessor<Storage, double, Parity> populations;
  double uniform_force;
  int what;
  KOKKOS_FORCEINLINE_FUNCTION double operator()(const int node, int, int, int) const {
    double g[19];
    populations.load(node, g);
    const auto m = macroscopic<double>(g, uniform_force, 0, 0);
    if (what == 0) return m.density_shift;
    return m.u[what - 1] * (1 + m.density_shift);
  }
};

KOKKOS_FORCEINLINE_FUNCTION constexpr int alternating(const int dimension, const int x, const int y, const int z) {
  return (dimension == 0 ? x : dimension == 1 ? y : z) % 2 == 0 ? 1 : -1;
}

/// Momentum along a direction, its sign turned at every second node along this direction.
template <class Storage, int Parity>
struct StaggeredMoment {
  NodeMoment<Storage, Parity> momentum;
  int dimension;
  KOKKOS_FORCEINLINE_FUNCTION double operator()(const int node, const int x, const int y, const int z) const {
    return alternating(dimension, x, y, z) * momentum(node, x, y, z);
  }
};

template <class Real>
struct AddStaggeredForce {
  VectorField<Real> force;
  int dimension;
  Real amplitude;
  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int node, const int x, const int y, const int z) const {
    force(node, dimension) += Real(alternating(dimension, x, y, z)) * amplitude;
  }
};

template <class Storage, int Parity, class Out>
struct NodeVelocity {
  StreamingAccessor<Storage, double, Parity> populations;
  double uniform_force;
  Kokkos::View<Out* [3], Kokkos::LayoutRight, MemSpace> out;
  int nx, ny;
  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int node, const int x, const int y, const int z) const {
    double g[19];
    populations.load(node, g);
    const auto m = macroscopic<double>(g, uniform_force, 0, 0);
    for (int k = 0; k < 3; ++k) out((z * ny + y) * nx + x, k) = static_cast<Out>(m.u[k]);
  }
};

/// 1 where a node is out of bounds or not a number.
template <class Storage, int Parity>
struct BrokenNode {
  StreamingAccessor<Storage, Storage, Parity> populations;
  Storage uniform_force, density, speed_squared;
  KOKKOS_FORCEINLINE_FUNCTION int operator()(const int node) const {
    Storage g[19];
    populations.load(node, g);
    const auto m = macroscopic<Storage>(g, uniform_force, 0, 0);
    const Storage squared = m.u[0] * m.u[0] + m.u[1] * m.u[1] + m.u[2] * m.u[2];
    return !(Kokkos::fabs(m.density_shift) <= density) | !(squared <= speed_squared);
  }
};

/// The smallest number of a broken node, counted through z, y, x.
template <class Storage, int Parity>
struct FirstBroken {
  BrokenNode<Storage, Parity> broken;
  int nx, ny;
  Array1<int> first;
  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int node, const int x, const int y, const int z) const {
    if (broken(node)) Kokkos::atomic_min(&first(0), (z * ny + y) * nx + x);
  }
};

template <class Storage, int Parity>
struct StateOfNode {
  StreamingAccessor<Storage, double, Parity> populations;
  double uniform_force;
  Array1<double> out;
  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int node, int, int, int) const {
    double g[19];
    populations.load(node, g);
    const auto m = macroscopic<double>(g, uniform_force, 0, 0);
    out(0) = 1 + m.density_shift;
    out(1) = Kokkos::sqrt(m.u[0] * m.u[0] + m.u[1] * m.u[1] + m.u[2] * m.u[2]);
  }
};

/// One population from the lattice to a plain array [nz][ny][nx], or back.
template <class Storage, class Accessor, bool ToLattice>
struct CopyPopulation {
  Accessor populations;
  Array1<Storage> plain;
  int direction, nx, ny;
  KOKKOS_FORCEINLINE_FUNCTION void leave_row(const int first, const int length) const requires(ToLattice) { populations.template wrap_row<false>(first, length); }
  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int node, const int x, const int y, const int z) const {
    Storage& on_lattice = populations.slot(node, direction);
    Storage& on_plain = plain((z * ny + y) * nx + x);
    if constexpr (ToLattice)
      on_lattice = on_plain;
    else
      on_plain = on_lattice;
  }
};

}  // namespace corpuscle
