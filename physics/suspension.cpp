#include "physics/suspension.hpp"

#include <Kokkos_Profiling_ScopedRegion.hpp>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "physics/cell_sampler.hpp"
#include "physics/contact.hpp"
#include "physics/coupling.hpp"
#include "physics/guards.hpp"
#include "physics/membrane.hpp"
#include "physics/stretching.hpp"
#include "physics/suspension_sample.hpp"
#include "physics/vertex_motion.hpp"

namespace corpuscle {

FluidParameters fluid_parameters(const Problem& problem, const LatticeParameters& lattice) {
  FluidParameters p;
  p.nodes = lattice.nodes;
  p.collision = problem.accuracy.collision;
  p.relaxation_time = lattice.relaxation_time;
  p.magic_parameter = problem.accuracy.magic_parameter;
  p.walls = problem.box.walls;
  if (problem.flow.kind == FlowKind::shear) p.wall_velocity = {-lattice.wall_velocity, lattice.wall_velocity};
  p.body_force = lattice.body_force;
  p.needs_force = !problem.cells.empty();
  if (p.needs_force) p.halo = Coupling<double>::halo_width(problem.accuracy.delta_kernel);
  return p;
}

namespace {

/// Steps between two looks at the staggered momentum. Where stiff membranes feed it, it grows by a few per cent meanwhile (docs/stability.md).
constexpr std::int64_t staggered_every = 100;

ContactParameters contact_parameters(const LatticeParameters& lattice) {
  ContactParameters p;
  p.strength = lattice.contact_strength;
  p.range = lattice.contact_range;
  p.expected_move = (lattice.mach_number > 0 ? 2 * lattice.mach_number : 0.1) * speed_of_sound * lattice.coupling_every;
  return p;
}

template <class Real>
class SuspensionOf final : public Suspension {
 public:
  SuspensionOf(const Problem& problem, const LatticeParameters& lattice, std::vector<CellType> types, const std::vector<double>& positions)
      : problem_(problem), lattice_(lattice), fluid_(fluid_parameters(problem, lattice)) {
    fluid_.initialise();
    const PeriodicBox box(fluid_.grid(), problem.box.walls);
    if (types.empty()) {
      guards_ = std::make_unique<Guards>(problem, lattice, box, nullptr);
      return;
    }
    cells_ = std::make_unique<Cells>(std::move(types), positions);
    coupling_ = std::make_unique<Coupling<Real>>(fluid_.grid(), problem.box.walls, problem.accuracy.delta_kernel);
    sampler_ = std::make_unique<CellSampler>(*cells_, box);
    for (const auto& type : cells_->types())
      membranes_.push_back(make_membrane(type.reference, type.moduli, problem.accuracy.membrane_precision, type.first_vertex, type.count));
    if (problem.contact.enabled)
      contact_ = std::make_unique<Contact>(box, contact_parameters(lattice), cells_->cell_of_vertex());
    if (Stretching::needed(problem)) stretching_ = std::make_unique<Stretching>(problem, lattice, cells_->types());
    motion_ = std::make_unique<VertexMotion>(cells_->types(), problem.accuracy.vertex_update, mobility(), lattice.coupling_every);
    guards_ = std::make_unique<Guards>(problem, lattice, box, cells_.get());
  }

  void settle() override {
    constexpr int rounds = 40;
    if (cells_) corpuscle::settle(cells_->types(), mobility(), rounds, cells_->positions(), cells_->forces(), force_operator());
  }

  void step() override { step_with(nullptr); }

  Sample step_and_measure() override {
    Sample sample;
    sample.step = fluid_.step();
    sample.strain = lattice_.shear_rate * double(fluid_.step());
    step_with(&sample);
    return sample;
  }

  Snapshot snapshot(bool with_fluid) const override {
    Snapshot s;
    s.step = fluid_.step();
    s.strain = lattice_.shear_rate * double(fluid_.step());
    if (cells_) {
      s.positions = cells_->positions_host();
      s.velocities = cells_->velocities_host();
    }
    if (with_fluid) s.fluid_velocity = fluid_.velocity_host();
    return s;
  }

  SuspensionState state() const override {
    SuspensionState s;
    s.step = fluid_.step();
    if (cells_) {
      s.positions = cells_->positions_host();
      s.velocities = cells_->velocities_host();
      s.motion = motion_->state();
    }
    return s;
  }
  Population population(int direction) const override { return fluid_.population(direction); }
  void restore(const SuspensionState& state, const PopulationSource& population) override {
    fluid_.restore(state.step, [&](int direction) {
      return std::visit([](auto&& values) { return std::vector<Real>(values.begin(), values.end()); }, population(direction));
    });
    if (!cells_) return;
    cells_->restore(state.positions, state.velocities);
    motion_->restore(state.motion);
    forces_known_ = false;
  }

  void check() override {
    guards_->check(fluid_, cells_.get(), contact_.get());
    if (!cells_ || forces_known_) return;
    compute_forces(cells_->positions(), cells_->forces());  // a start is judged by its forces and contacts too, once its positions are good enough to compute them
    guards_->check(fluid_, cells_.get(), contact_.get());
  }
  std::array<double, 3> fluid_momentum() const override { return fluid_.momentum(); }
  std::size_t bytes() const override {
    std::size_t total = fluid_.bytes() + guards_->bytes();
    if (cells_) total += cells_->bytes() + coupling_->bytes() + sampler_->bytes() + motion_->bytes();
    for (const auto& m : membranes_) total += m->bytes();
    if (contact_) total += contact_->bytes();
    if (stretching_) total += stretching_->bytes();
    return total;
  }

 private:
  /// All forces on the vertices. With a sampler the stresses are measured on the way: external forces are no part of the particle stress.
  void compute_forces(const VertexVectors& positions, const VertexVectors& forces, CellSampler* sampler = nullptr) {
    forces_known_ = true;
    for (const auto& membrane : membranes_) membrane->compute_forces(positions, forces);
    if (sampler) sampler->measure_membrane_stress(*cells_);
    if (contact_) {
      try {
        contact_->add_forces(positions, forces);
      } catch (const SimulationError&) {
        check();  // knows the cause better
        throw;
      }
    }
    if (sampler && contact_) sampler->measure_contact_stress(*cells_, *contact_);
    if (stretching_) stretching_->add_forces(forces);
  }
  MobilityModel mobility() const { return mobility_model(cells_->types(), problem_.accuracy.delta_kernel); }
  ForceOperator force_operator() {
    return [this](const VertexVectors& positions, const VertexVectors& forces) { compute_forces(positions, forces); };
  }

  /// The time step, or the steps up to the next coupling. With a sample, each quantity is measured at the moment when it is known, at time t = step.
  void step_with(Sample* sample) {
    if (cells_) {
      compute_forces(cells_->positions(), cells_->forces(), sample ? sampler_.get() : nullptr);
      coupling_->spread(cells_->positions(), cells_->forces(), fluid_.force());
      if (sample && problem_.box.walls) spread_on_walls_ = fluid_.wall_force_from_spreading();
      // Several steps under one force feed no staggered momentum, and could not take it away.
      if (lattice_.coupling_every == 1 && fluid_.step() % staggered_every == staggered_every - 1) fluid_.remove_staggered_momentum();
      fluid_.coupled_steps(lattice_.coupling_every);
      coupling_->interpolate(motion_->halfway(cells_->positions(), cells_->velocities()), cells_->velocities(), fluid_.velocity());
      if (sample) sampler_->measure_shape(*cells_);
      motion_->advance(cells_->positions(), cells_->velocities(), cells_->forces(), force_operator());
    } else {
      fluid_.collide_stream();
    }
    if (sample) finish(*sample);
  }

  void finish(Sample& sample) const {
    const Kokkos::Profiling::ScopedRegion region("average_over_cells");  // the name of what remains when the kernels are subtracted
    if (cells_) sample.cells = sampler_->collect();
    average_over_cells(sample, cells_ ? cells_->types() : std::vector<CellType>{}, lattice_, problem_.box.walls);
    const double none = std::numeric_limits<double>::quiet_NaN();
    sample.wall_shear_stress = {none, none};
    sample.wall_relative_viscosity = none;
    sample.velocity_max = velocity_max();
    if (!problem_.box.walls) return;
    sample.wall_shear_stress = fluid_.wall_shear_stress();
    if (cells_) {
      // What was spread beyond a wall acts on the wall itself: traction +sigma_xz below, -sigma_xz above.
      sample.wall_shear_stress[0] += spread_on_walls_[0];
      sample.wall_shear_stress[1] -= spread_on_walls_[1];
    }
    const double unit = lattice_.viscosity * lattice_.shear_rate;
    if (problem_.flow.kind == FlowKind::shear)
      sample.wall_relative_viscosity = 0.5 * (sample.wall_shear_stress[0] + sample.wall_shear_stress[1]) / unit;
    if (problem_.flow.kind == FlowKind::poiseuille) {
      // Apparent viscosity: the flow rate of the fluid alone over the present one. The mean of the parabola over nodes half a spacing from the walls is
      // g (H^2 + 1/2)/(12 nu).
      const double height = lattice_.nodes[2];
      sample.relative_viscosity = lattice_.body_force * (height * height + 0.5) / (12 * lattice_.viscosity) / (fluid_.momentum()[0] / lattice_.box_volume());
      sample.bulk_relative_viscosity = none;
    }
  }

  double velocity_max() const;

  Problem problem_;
  LatticeParameters lattice_;
  Fluid<Real> fluid_;
  std::unique_ptr<Cells> cells_;
  std::unique_ptr<Coupling<Real>> coupling_;
  std::unique_ptr<CellSampler> sampler_;
  std::vector<std::unique_ptr<Membrane>> membranes_;
  std::unique_ptr<Contact> contact_;
  std::unique_ptr<Stretching> stretching_;
  std::unique_ptr<VertexMotion> motion_;
  std::unique_ptr<Guards> guards_;
  std::array<double, 2> spread_on_walls_{};
  bool forces_known_ = false;  ///< for some positions near the present ones; not before the first step
};

/// Largest squared speed; anything that is not a number counts as infinite.
double largest_squared_speed(const VertexVectors& u) {
  double largest = 0;
  Kokkos::parallel_reduce("velocity_max", Kokkos::RangePolicy<ExecSpace>(0, u.extent(0)), KOKKOS_LAMBDA(const int v, double& worst) {
    double squared = u(v, 0) * u(v, 0) + u(v, 1) * u(v, 1) + u(v, 2) * u(v, 2);
    if (!(squared < 1e300)) squared = 1e300;
    worst = squared > worst ? squared : worst;
  }, Kokkos::Max<double>(largest));
  return largest;
}

template <class Real>
double SuspensionOf<Real>::velocity_max() const {
  return cells_ ? std::sqrt(largest_squared_speed(cells_->velocities())) : 0.0;
}

}  // namespace

std::unique_ptr<Suspension> make_suspension(const Problem& problem, const LatticeParameters& lattice, std::vector<CellType> types,
                                            const std::vector<double>& positions) {
  if (problem.accuracy.precision == Precision::single_precision)
    return std::make_unique<SuspensionOf<float>>(problem, lattice, std::move(types), positions);
  return std::make_unique<SuspensionOf<double>>(problem, lattice, std::move(types), positions);
}

}  // namespace corpuscle
