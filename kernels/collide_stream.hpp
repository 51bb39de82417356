// One time step of the lattice Boltzmann equation on a node, in place.
#pragma once
#include "core/halo.hpp"
#include "kernels/collision.hpp"
#include "kernels/streaming.hpp"
#include "kernels/vector_halo.hpp"

namespace corpuscle {

/// Where the force density of a node comes from, and what becomes of its fields. `none` and `uniform` need no field and no clearing pass; the others read the force field.
enum class Forcing {
  none,
  uniform,
  field,       ///< the force is cleared, the velocity written
  held,        ///< the force stays for the next step, nobody asks for the velocity
  held_shown,  ///< the force stays, the velocity is written
  last         ///< the force is cleared, the velocity is the mean of this step's and the one that was there
};
constexpr bool reads_field(Forcing f) { return f != Forcing::none && f != Forcing::uniform; }
constexpr bool clears_field(Forcing f) { return f == Forcing::field || f == Forcing::last; }
constexpr bool writes_velocity(Forcing f) { return reads_field(f) && f != Forcing::held; }

/// f(x + c, t + 1) = f(x, t) + collision + force (docs/theory/model.md, Fluid). The force is read and cleared and the force-corrected velocity written on the way, so that coupling
/// needs no sweep of its own; the uniform force is added in all forced forms.
template <class Storage, class Compute, int Parity, Forcing forcing>
struct CollideStream {
  StreamingAccessor<Storage, Compute, Parity> populations;
  PairRelaxation<Compute> relaxation;
  Compute uniform_force;          ///< along x
  VectorField<Compute> force;     ///< empty unless the force field is read
  VectorField<Compute> velocity;  ///< likewise
  int halo;                       ///< layers of the fields

  /// Where loops go over rows these make their own periodic images along x, while the lines are in the cache; elsewhere passes over the halo do.
  KOKKOS_FORCEINLINE_FUNCTION void enter_row(const int first, const int length) const {
    populations.template wrap_row<true>(first, length);
    if constexpr (reads_field(forcing)) halo_of_row(first, length, halo, ScatterForce<Compute>{force, Compute(1)});
  }
  KOKKOS_FORCEINLINE_FUNCTION void leave_row(const int first, const int length) const {
    populations.template wrap_row<false>(first, length);
    if constexpr (writes_velocity(forcing)) halo_of_row(first, length, halo, GatherVelocity<Compute>{velocity});
  }

  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int node) const {
    Compute g[19];
    populations.load(node, g);
    Compute fx = 0, fy = 0, fz = 0;
    if constexpr (forcing != Forcing::none) fx = uniform_force;
    if constexpr (reads_field(forcing)) {
      fx += force(node, 0);
      fy += force(node, 1);
      fz += force(node, 2);
    }
    if constexpr (clears_field(forcing)) {
      force(node, 0) = Compute(0);
      force(node, 1) = Compute(0);
      force(node, 2) = Compute(0);
      force(node, 3) = Compute(0);
    }
    const Macroscopic<Compute> m = macroscopic(g, fx, fy, fz);
    if constexpr (forcing == Forcing::last) {
      velocity(node, 0) = Compute(0.5) * (velocity(node, 0) + m.u[0]);
      velocity(node, 1) = Compute(0.5) * (velocity(node, 1) + m.u[1]);
      velocity(node, 2) = Compute(0.5) * (velocity(node, 2) + m.u[2]);
    } else if constexpr (writes_velocity(forcing)) {
      velocity(node, 0) = m.u[0];
      velocity(node, 1) = m.u[1];
      velocity(node, 2) = m.u[2];
      velocity(node, 3) = Compute(0);
    }
    relaxation.template collide<forcing != Forcing::none>(g, m, fx, fy, fz);
    populations.store(node, g);
  }
};

}  // namespace corpuscle
