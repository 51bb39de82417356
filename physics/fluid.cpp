#include "physics/fluid.hpp"

#include "core/halo.hpp"
#include "core/huge_pages.hpp"
#include "core/to_host.hpp"
#include "kernels/node_moments.hpp"
#include "kernels/population_halo.hpp"
#include "kernels/vector_halo.hpp"

namespace corpuscle {
namespace {

/// Bodies that write populations take care of x by themselves where loops go over rows (wrap_row), also on the halo nodes above the upper wall.
constexpr int first_exchanged = loops_over_rows ? 1 : 0;

template <class Real>
struct HaloForceX {
  VectorField<Real> force;
  KOKKOS_FORCEINLINE_FUNCTION double operator()(const int node, int, int, int) const { return force(node, 0); }
};

}  // namespace

template <class Storage, class Compute>
Fluid<Storage, Compute>::Fluid(const FluidParameters& parameters)
    : parameters_(parameters),
      grid_{parameters.nodes[0], parameters.nodes[1], parameters.nodes[2], parameters.halo},
      relaxation_(parameters.collision == CollisionKind::bgk
                      ? PairRelaxation<Compute>::bgk(parameters.relaxation_time)
                      : PairRelaxation<Compute>::trt(parameters.relaxation_time, parameters.magic_parameter)),
      populations_(zeros_on_huge_pages<Populations<Storage>>("populations", 19, population_stride<Storage>(grid_.padded_nodes()))) {
  if (parameters.needs_force) {
    force_ = zeros_on_huge_pages<VectorField<Compute>>("force", grid_.padded_nodes());
    velocity_ = zeros_on_huge_pages<VectorField<Compute>>("velocity", grid_.padded_nodes());
  }
}

template <class Storage, class Compute>
template <int Parity>
void Fluid<Storage, Compute>::exchange_populations(bool to_halo, int first) {
  const auto exchange = [&](int dimension) {
    halo_for("exchange_populations", grid_, dimension, 1, HaloPartner::periodic,
             ExchangePopulations<Storage, Parity>{populations_, dimension, to_halo});
  };
  const int dimensions = parameters_.walls ? 2 : 3;
  if (to_halo)
    for (int d = first; d < dimensions; ++d) exchange(d);
  else
    for (int d = dimensions - 1; d >= first; --d) exchange(d);
}

template <class Storage, class Compute>
template <int Parity>
void Fluid<Storage, Compute>::bounce_back() {
  // The halo nodes beyond the periodic sides are written by diagonal directions too, hence the wider box above the upper wall.
  lattice_for("bounce_back", grid_, {-1, grid_.nx + 1, -1, grid_.ny + 1, grid_.nz, grid_.nz + 1},
              BounceBack<Storage, Compute, Parity, true>{populations_, Compute(parameters_.wall_velocity[1])});
  lattice_for("bounce_back", grid_, {0, grid_.nx, 0, grid_.ny, 0, 1},
              BounceBack<Storage, Compute, Parity, false>{populations_, Compute(parameters_.wall_velocity[0])});
}

template <class Storage, class Compute>
template <int Parity>
void Fluid<Storage, Compute>::collide_stream_parity(Forcing field) {
  exchange_populations<Parity>(true, first_exchanged);
  const auto sweep = [&](auto forcing) {
    lattice_for("collide_stream", grid_, interior(grid_),
                CollideStream<Storage, Compute, Parity, decltype(forcing)::value>{
                    {populations_, PairOffsets(grid_)}, relaxation_, Compute(parameters_.body_force), force_, velocity_, grid_.halo});
  };
  if (parameters_.needs_force) {
    switch (field) {
      case Forcing::held: sweep(std::integral_constant<Forcing, Forcing::held>{}); break;
      case Forcing::held_shown: sweep(std::integral_constant<Forcing, Forcing::held_shown>{}); break;
      case Forcing::last: sweep(std::integral_constant<Forcing, Forcing::last>{}); break;
      default: sweep(std::integral_constant<Forcing, Forcing::field>{});
    }
  } else if (parameters_.body_force != 0)
    sweep(std::integral_constant<Forcing, Forcing::uniform>{});
  else
    sweep(std::integral_constant<Forcing, Forcing::none>{});
  exchange_populations<Parity>(false, first_exchanged);
  if (parameters_.walls) bounce_back<Parity>();
}

template <class Storage, class Compute>
void Fluid<Storage, Compute>::collide_stream_with(Forcing field) {
  if (step_ % 2 == 0)
    collide_stream_parity<0>(field);
  else
    collide_stream_parity<1>(field);
  ++step_;
}

template <class Storage, class Compute>
void Fluid<Storage, Compute>::collide_stream() {
  collide_stream_with(Forcing::field);
}

template <class Storage, class Compute>
void Fluid<Storage, Compute>::collide_stream_holding_force(int steps) {
  for (int i = 2; i < steps; ++i) collide_stream_with(Forcing::held);
  if (steps > 1) collide_stream_with(Forcing::held_shown);
  collide_stream_with(steps > 1 ? Forcing::last : Forcing::field);
}

template <class Storage, class Compute>
void Fluid<Storage, Compute>::coupled_steps(int steps) {
  scatter_force_down_to(first_exchanged);
  collide_stream_holding_force(steps);
  gather_velocity_from(first_exchanged);
}

template <class Storage, class Compute>
void Fluid<Storage, Compute>::set_populations(const std::vector<double>& velocity, double shear_rate) {
  step_ = 0;
  Kokkos::View<double* [3], Kokkos::LayoutRight, MemSpace> on_device("initial_velocity", velocity.size() / 3);
  if (!velocity.empty())
    Kokkos::deep_copy(on_device, Kokkos::View<const double* [3], Kokkos::LayoutRight, Kokkos::HostSpace>(velocity.data(), velocity.size() / 3));
  lattice_for("initialise", grid_, interior(grid_),
              SetPopulations<Storage, Compute>{{populations_, PairOffsets(grid_)},
                                               on_device,
                                               grid_.nx,
                                               grid_.ny,
                                               grid_.nz,
                                               parameters_.wall_velocity[0],
                                               shear_rate,
                                               parameters_.relaxation_time,
                                               parameters_.walls ? parameters_.body_force * 1.5 / (parameters_.relaxation_time - 0.5) : 0.0,
                                               0.5 * parameters_.body_force});
  exchange_populations<0>(false, first_exchanged);
}

template <class Storage, class Compute>
void Fluid<Storage, Compute>::initialise() {
  const double shear_rate = parameters_.walls ? (parameters_.wall_velocity[1] - parameters_.wall_velocity[0]) / grid_.nz : 0.0;
  set_populations({}, shear_rate);
}

template <class Storage, class Compute>
void Fluid<Storage, Compute>::initialise(const std::vector<double>& velocity) {
  set_populations(velocity, 0);
}

template <class Storage, class Compute>
void Fluid<Storage, Compute>::scatter_force_down_to(int last) {
  for (int d = 2; d >= last; --d) {
    const bool wall = d == 2 && parameters_.walls;
    halo_for("scatter_force", grid_, d, grid_.halo, wall ? HaloPartner::mirror : HaloPartner::periodic,
             ScatterForce<Compute>{force_, Compute(wall ? -1 : 1)});
  }
}

template <class Storage, class Compute>
void Fluid<Storage, Compute>::gather_velocity_from(int first) {
  for (int d = first; d < 3; ++d) {
    if (d == 2 && parameters_.walls)
      halo_for("gather_velocity", grid_, d, grid_.halo, HaloPartner::mirror,
               ExtendVelocity<Compute>{velocity_, Compute(parameters_.wall_velocity[0]), Compute(parameters_.wall_velocity[1])});
    else
      halo_for("gather_velocity", grid_, d, grid_.halo, HaloPartner::periodic, GatherVelocity<Compute>{velocity_});
  }
}

template <class Storage, class Compute>
std::array<double, 2> Fluid<Storage, Compute>::wall_force_from_spreading() const {
  const int h = grid_.halo;
  const double area = double(grid_.nx) * grid_.ny;
  const auto sum = [&](int z0, int z1) {
    return lattice_sum("wall_force", grid_, {-h, grid_.nx + h, -h, grid_.ny + h, z0, z1}, HaloForceX<Compute>{force_});
  };
  // Of a force F in the halo the fluid gets -F instead of F, so the wall gets 2 F.
  return {2 * sum(-h, 0) / area, 2 * sum(grid_.nz, grid_.nz + h) / area};
}

template <class Storage, class Compute>
template <class Body>
void Fluid<Storage, Compute>::with_accessor(const Body& body) const {
  // Populations are read where the halo is current: fill it for the parity of the coming step, which changes no physical state.
  auto& self = const_cast<Fluid&>(*this);
  if (step_ % 2 == 0) {
    self.template exchange_populations<0>(true);
    body(StreamingAccessor<Storage, double, 0>{populations_, PairOffsets(grid_)}, std::integral_constant<int, 0>{});
  } else {
    self.template exchange_populations<1>(true);
    body(StreamingAccessor<Storage, double, 1>{populations_, PairOffsets(grid_)}, std::integral_constant<int, 1>{});
  }
}

template <class Storage, class Compute>
std::array<double, 2> Fluid<Storage, Compute>::wall_shear_stress() const {
  const double area = double(grid_.nx) * grid_.ny;
  const LatticeBox lower{0, grid_.nx, 0, grid_.ny, 0, 1}, upper{0, grid_.nx, 0, grid_.ny, grid_.nz - 1, grid_.nz};
  const PairOffsets offsets(grid_);
  const auto stress = [&](auto parity) -> std::array<double, 2> {
    constexpr int P = decltype(parity)::value;
    const double on_lower = lattice_sum("wall_stress", grid_, lower, WallMomentum<Storage, P, false>{populations_, offsets});
    const double on_upper = lattice_sum("wall_stress", grid_, upper, WallMomentum<Storage, P, true>{populations_, offsets});
    // The traction on the lower wall is +sigma_xz, on the upper wall -sigma_xz.
    return {on_lower / area, -on_upper / area};
  };
  return step_ % 2 == 1 ? stress(std::integral_constant<int, 0>{}) : stress(std::integral_constant<int, 1>{});
}

template <class Storage, class Compute>
std::vector<Storage> Fluid<Storage, Compute>::population(int direction) const {
  Array1<Storage> plain(Kokkos::view_alloc(Kokkos::WithoutInitializing, "population"), grid_.nodes());
  with_accessor([&](auto accessor, auto) {
    lattice_for("read_population", grid_, interior(grid_), CopyPopulation<Storage, decltype(accessor), false>{accessor, plain, direction, grid_.nx, grid_.ny});
  });
  return to_host(plain);
}

template <class Storage, class Compute>
template <int Parity>
void Fluid<Storage, Compute>::restore_parity(const std::function<std::vector<Storage>(int)>& population) {
  using Accessor = StreamingAccessor<Storage, double, Parity>;
  const Array1<Storage> plain(Kokkos::view_alloc(Kokkos::WithoutInitializing, "population"), grid_.nodes());
  for (int q = 0; q < 19; ++q) {
    const std::vector<Storage> values = population(q);
    Kokkos::deep_copy(plain, Kokkos::View<const Storage*, Kokkos::LayoutRight, Kokkos::HostSpace>(values.data(), values.size()));
    lattice_for("write_population", grid_, interior(grid_),
                CopyPopulation<Storage, Accessor, true>{Accessor{populations_, PairOffsets(grid_)}, plain, q, grid_.nx, grid_.ny});
    Kokkos::fence();  // `values` is gone after this
  }
  exchange_populations<Parity>(false, first_exchanged);
}

template <class Storage, class Compute>
void Fluid<Storage, Compute>::restore(std::int64_t step, const std::function<std::vector<Storage>(int)>& population) {
  step_ = step;
  if (step % 2 == 0)
    restore_parity<0>(population);
  else
    restore_parity<1>(population);
}

template <class Storage, class Compute>
double Fluid<Storage, Compute>::mass_shift() const {
  double sum = 0;
  with_accessor([&](auto accessor, auto parity) {
    sum = lattice_sum("mass", grid_, interior(grid_), NodeMoment<Storage, decltype(parity)::value>{accessor, parameters_.body_force, 0});
  });
  return sum;
}

template <class Storage, class Compute>
std::array<double, 3> Fluid<Storage, Compute>::momentum() const {
  std::array<double, 3> sum{};
  with_accessor([&](auto accessor, auto parity) {
    for (int k = 0; k < 3; ++k)
      sum[k] = lattice_sum("momentum", grid_, interior(grid_), NodeMoment<Storage, decltype(parity)::value>{accessor, parameters_.body_force, k + 1});
  });
  return sum;
}

template <class Storage, class Compute>
std::array<double, 3> Fluid<Storage, Compute>::staggered_momentum() const {
  std::array<double, 3> mean{};
  with_accessor([&](auto accessor, auto parity) {
    for (int k = 0; k < (parameters_.walls ? 2 : 3); ++k) {
      if (parameters_.nodes[k] % 2 != 0) continue;
      const NodeMoment<Storage, decltype(parity)::value> momentum{accessor, parameters_.body_force, k + 1};
      mean[k] = lattice_sum("staggered_momentum", grid_, interior(grid_), StaggeredMoment<Storage, decltype(parity)::value>{momentum, k}) / double(grid_.nodes());
    }
  });
  return mean;
}

template <class Storage, class Compute>
void Fluid<Storage, Compute>::remove_staggered_momentum() {
  const auto mean = staggered_momentum();
  for (int k = 0; k < 3; ++k)
    if (mean[k] != 0) lattice_for("staggered_force", grid_, interior(grid_), AddStaggeredForce<Compute>{force_, k, Compute(-mean[k])});
}

template <class Storage, class Compute>
void Fluid<Storage, Compute>::count_broken(double density, double speed, const DeviceCount& count) const {
  with_accessor([&](auto accessor, auto parity) {
    constexpr int P = decltype(parity)::value;
    lattice_count("guard_nodes", grid_, interior(grid_),
                  BrokenNode<Storage, P>{{accessor.f, accessor.offsets}, Storage(parameters_.body_force), Storage(density), Storage(speed * speed)}, count);
  });
}

template <class Storage, class Compute>
std::optional<NodeState> Fluid<Storage, Compute>::first_broken(double density, double speed) const {
  const int none = int(grid_.nodes());
  std::optional<NodeState> found;
  with_accessor([&](auto accessor, auto parity) {
    constexpr int P = decltype(parity)::value;
    const Array1<int> first("first_broken", 1);
    Kokkos::deep_copy(first, none);
    const BrokenNode<Storage, P> broken{{accessor.f, accessor.offsets}, Storage(parameters_.body_force), Storage(density), Storage(speed * speed)};
    lattice_for("guard_first", grid_, interior(grid_), FirstBroken<Storage, P>{broken, grid_.nx, grid_.ny, first});
    const int flat = to_host(first)[0];
    if (flat == none) return;
    const int x = flat % grid_.nx, y = flat / grid_.nx % grid_.ny, z = flat / (grid_.nx * grid_.ny);
    const Array1<double> state("state_of_node", 2);
    lattice_for("guard_first", grid_, {x, x + 1, y, y + 1, z, z + 1}, StateOfNode<Storage, P>{accessor, parameters_.body_force, state});
    const auto host = to_host(state);
    found = NodeState{{x, y, z}, host[0], host[1]};
  });
  return found;
}

namespace {
template <class Out, class Storage, class Compute>
std::vector<Out> velocities(const Grid& grid, double body_force, const Fluid<Storage, Compute>&, auto&& with_accessor) {
  Kokkos::View<Out* [3], Kokkos::LayoutRight, MemSpace> out("velocity_out", grid.nodes());
  with_accessor([&](auto accessor, auto parity) {
    lattice_for("velocity_out", grid, interior(grid), NodeVelocity<Storage, decltype(parity)::value, Out>{accessor, body_force, out, grid.nx, grid.ny});
  });
  return to_host(out);
}
}  // namespace

template <class Storage, class Compute>
std::vector<float> Fluid<Storage, Compute>::velocity_host() const {
  return velocities<float>(grid_, parameters_.body_force, *this, [&](auto&& body) { with_accessor(body); });
}

template <class Storage, class Compute>
std::vector<double> Fluid<Storage, Compute>::velocity_host_double() const {
  return velocities<double>(grid_, parameters_.body_force, *this, [&](auto&& body) { with_accessor(body); });
}

template <class Storage, class Compute>
std::size_t Fluid<Storage, Compute>::bytes() const {
  return populations_.span() * sizeof(Storage) + (force_.span() + velocity_.span()) * sizeof(Compute);
}

template <class Storage, class Compute>
std::size_t Fluid<Storage, Compute>::predicted_bytes(const FluidParameters& p) {
  const std::size_t nodes = Grid{p.nodes[0], p.nodes[1], p.nodes[2], p.halo}.padded_nodes();
  return 19 * population_stride<Storage>(nodes) * sizeof(Storage) + (p.needs_force ? 2 * 4 * nodes * sizeof(Compute) : 0);
}

template class Fluid<float, float>;
template class Fluid<double, double>;

}  // namespace corpuscle
