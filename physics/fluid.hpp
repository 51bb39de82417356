// The fluid: D3Q19 lattice Boltzmann with in-place streaming, periodic in x and y, walls or periodic in z (docs/theory/model.md, Fluid).
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/grid.hpp"
#include "core/lattice_for.hpp"
#include "core/types.hpp"
#include "kernels/collide_stream.hpp"
#include "physics/problem.hpp"

namespace corpuscle {

/// All in lattice units.
struct FluidParameters {
  std::array<int, 3> nodes{};
  int halo = 1;                      ///< layers around the lattice; the delta kernel needs 1 (2-, 3-point) or 2 (4-point)
  CollisionKind collision = CollisionKind::bgk;
  double relaxation_time = 1;
  double magic_parameter = 3.0 / 16.0;
  bool walls = true;                 ///< half-way bounce-back at z = 0 and z = nz
  std::array<double, 2> wall_velocity{};  ///< along x, lower and upper
  double body_force = 0;             ///< uniform force density along x
  bool needs_force = false;          ///< a force field that changes from node to node (cells)
};

struct NodeState {
  std::array<int, 3> node{};
  double density = 1;
  double speed = 0;
};

template <class Storage, class Compute = Storage>
class Fluid {
 public:
  explicit Fluid(const FluidParameters& parameters);

  /// The plane flow that walls and body force drive, including its viscous stress: linear profile, parabola or rest, stationary from step 0.
  void initialise();
  /// Equilibrium at velocities given on the host, [nz][ny][nx][3] (Taylor-Green and other tests).
  void initialise(const std::vector<double>& velocity);

  /// One step: collide and stream in place, bounce back at the walls. Reads and clears `force()`, writes `velocity()` where the scene has them.
  void collide_stream();
  /// So many steps under the same force. With two or more `velocity()` is the mean of the last two: it doesn't see momenta that turn their sign at each step.
  void collide_stream_holding_force(int steps);

  /// Prepares `force()` for the collision: adds what was spread into the halo to the nodes that it stands for. At a wall the halo is the mirror
  /// image with opposite sign (adjoint of the no-slip extension in `gather_velocity`); the difference is a force on the wall.
  void scatter_force() { scatter_force_down_to(0); }
  /// Fills the halo of `velocity()`: periodic images, and u(-z) = 2 u_wall - u(z) beyond walls.
  void gather_velocity() { gather_velocity_from(0); }
  /// `scatter_force`, `collide_stream_holding_force`, `gather_velocity`, with fewer passes: where loops go over rows, each makes its images along x itself.
  void coupled_steps(int steps);

  /// Mean over the nodes of (-1)^x j_x, (-1)^y j_y, (-1)^z j_z. Collisions and streaming turn their signs at each step and damp none of them: no part of a flow, but what rounding and spread forces
  /// leave there stays. Zero along directions with an odd number of nodes or with walls, where nothing of the kind is kept.
  std::array<double, 3> staggered_momentum() const;
  /// Adds the force that takes the staggered momentum away in the coming step; after spreading, before `coupled_steps(1)`.
  void remove_staggered_momentum();

  /// Force along x on the lower and the upper wall (per area) of what has been spread beyond them; call before `scatter_force`.
  std::array<double, 2> wall_force_from_spreading() const;
  /// Viscous shear stress sigma_xz on the lower and upper wall in the last step, by momentum exchange.
  std::array<double, 2> wall_shear_stress() const;

  /// Population of a direction 0 ... 18 before the collision of the coming step, [nz][ny][nx]: with `step()` the whole state of the fluid.
  std::vector<Storage> population(int direction) const;
  /// Goes on from a state: `population(direction)` is asked for each direction in turn.
  void restore(std::int64_t step, const std::function<std::vector<Storage>(int)>& population);

  double mass_shift() const;                  ///< sum over nodes of rho - 1
  std::array<double, 3> momentum() const;     ///< sum over nodes of sum_i c_i f_i (+ F/2 with the uniform force)
  /// Velocities at the present time on the host, [nz][ny][nx][3].
  std::vector<float> velocity_host() const;
  std::vector<double> velocity_host_double() const;

  /// Nodes where |rho - 1| or |u| is larger than this, or not a number. Counted on the device, without waiting.
  void count_broken(double density, double speed, const DeviceCount& count) const;
  /// The first of them in the order of z, y, x, if there is one.
  std::optional<NodeState> first_broken(double density, double speed) const;

  const Grid& grid() const { return grid_; }
  const FluidParameters& parameters() const { return parameters_; }
  VectorField<Compute> force() const { return force_; }
  VectorField<Compute> velocity() const { return velocity_; }
  std::int64_t step() const { return step_; }
  std::size_t bytes() const;
  /// What `bytes` will be.
  static std::size_t predicted_bytes(const FluidParameters& parameters);

 private:
  void collide_stream_with(Forcing field);
  template <int Parity>
  void collide_stream_parity(Forcing field);
  void scatter_force_down_to(int last);
  void gather_velocity_from(int first);
  /// Along the dimensions from `first` on.
  template <int Parity>
  void exchange_populations(bool to_halo, int first = 0);
  template <int Parity>
  void bounce_back();
  template <int Parity>
  void restore_parity(const std::function<std::vector<Storage>(int)>& population);
  void set_populations(const std::vector<double>& velocity, double shear_rate);
  template <class Body>
  void with_accessor(const Body& body) const;

  FluidParameters parameters_;
  Grid grid_;
  PairRelaxation<Compute> relaxation_;
  Populations<Storage> populations_;
  VectorField<Compute> force_, velocity_;
  std::int64_t step_ = 0;
};

}  // namespace corpuscle
