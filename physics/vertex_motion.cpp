#include "physics/vertex_motion.hpp"

#include <algorithm>
#include <string>

#include "core/random.hpp"
#include "core/vertex_vectors.hpp"
#include "physics/mesh_device.hpp"

namespace corpuscle {
namespace {

constexpr int estimate_every = 64;   // steps between estimates of the stiffness: contacts change with the strain, and a strain unit has thousands of steps
constexpr int power_iterations = 8;
constexpr double margin = 1.3;       // eight iterations find the largest eigenvalue to 10-20 %, from below
constexpr double probe = 1e-3;       // lattice units: a displacement small against the range of contacts, large against rounding in single precision
constexpr int most_stages = 64;      // a membrane that asks for more moves with the last ones: the guards see it

using Range = Kokkos::RangePolicy<ExecSpace>;

/// Range of the vertices of a type.
Range vertices_of(const SurfaceMobility& type) { return Range(type.first_vertex, type.first_vertex + type.count * type.vertices); }

double largest_component(const VertexVectors& a) {
  double largest = 0;
  Kokkos::parallel_reduce("vertex_motion_norm", Range(0, a.extent(0)), KOKKOS_LAMBDA(const int v, double& worst) {
    for (int k = 0; k < 3; ++k) worst = Kokkos::fmax(worst, Kokkos::fabs(a(v, k)));
  }, Kokkos::Max<double>(largest));
  return largest;
}

/// smoothed = first factor of the mobilities applied to force - start_force.
void smooth_forces(const std::vector<SurfaceMobility>& mobilities, const VertexVectors& force, const VertexVectors& start_force, const VertexVectors& smoothed) {
  for (const auto& mobility : mobilities)
    Kokkos::parallel_for("smooth_forces", vertices_of(mobility), KOKKOS_LAMBDA(const int v) {
      const Vec3<double> g = mobility.smoothed_force(v, force, start_force);
      smoothed(v, 0) = g.x;
      smoothed(v, 1) = g.y;
      smoothed(v, 2) = g.z;
    });
}

/// velocities = M (force - start_force).
void mobility_velocities(const std::vector<SurfaceMobility>& mobilities, const VertexVectors& force, const VertexVectors& start_force, const VertexVectors& smoothed,
                         const VertexVectors& velocities) {
  smooth_forces(mobilities, force, start_force, smoothed);
  for (const auto& mobility : mobilities)
    Kokkos::parallel_for("mobility_velocities", vertices_of(mobility), KOKKOS_LAMBDA(const int v) {
      const Vec3<double> u = mobility.velocity(v, smoothed);
      velocities(v, 0) = u.x;
      velocities(v, 1) = u.y;
      velocities(v, 2) = u.z;
    });
}

/// Numbers in [-1, 1] without pattern, the same at every call: an estimate needs no state that a restart would have to keep.
void fill_noise(const VertexVectors& a) {
  Kokkos::parallel_for("vertex_motion_noise", Range(0, a.extent(0)), KOKKOS_LAMBDA(const int v) {
    for (int k = 0; k < 3; ++k) a(v, k) = 2 * uniform_from_bits(mix_bits((3 * std::uint64_t(v) + k + 1) * 0x9e3779b97f4a7c15ULL)) - 1;
  });
}

/// Largest eigenvalue of -M dF/dx, M the mobility, by power iteration with finite differences. The largest component as norm: it doesn't depend on the order of summation.
double largest_rate(const std::vector<SurfaceMobility>& mobilities, const VertexVectors& x, const VertexVectors& force, const VertexVectors& direction,
                    const VertexVectors& displaced, const VertexVectors& response, const ForceOperator& compute_forces) {
  fill_noise(direction);
  double rate = 0, length = 1;
  for (int i = 0; i < power_iterations; ++i) {
    const double scale = probe / length;
    Kokkos::parallel_for("vertex_motion_displace", Range(0, x.extent(0)), KOKKOS_LAMBDA(const int v) {
      for (int k = 0; k < 3; ++k) displaced(v, k) = x(v, k) + scale * direction(v, k);
    });
    compute_forces(displaced, response);
    mobility_velocities(mobilities, force, response, displaced, direction);
    length = largest_component(direction);
    rate = std::max(rate, length / probe);
    if (!(length > 0)) break;
  }
  return rate;
}

/// The stages that a rate asks for.
ChebyshevScheme scheme_for(double rate) { return ChebyshevScheme(ChebyshevScheme::stages_for(std::min(margin * rate, ChebyshevScheme::reach(most_stages)))); }

/// Stages of dx/ds = drift + M (F(x) - F0). `force` is scratch.
void chebyshev_stages(const ChebyshevScheme& scheme, const std::vector<SurfaceMobility>& mobilities, const VertexVectors& x, const VertexVectors& force, const VertexVectors& drift,
                      const VertexVectors& start_force, const VertexVectors& last, const VertexVectors& smoothed, const ForceOperator& compute_forces) {
  const double first = scheme.first;
  Kokkos::parallel_for("chebyshev_first", Range(0, x.extent(0)), KOKKOS_LAMBDA(const int v) {
    for (int k = 0; k < 3; ++k) {
      last(v, k) = x(v, k);
      x(v, k) += first * drift(v, k);
    }
  });
  for (const auto& stage : scheme.stages) {
    compute_forces(x, force);
    smooth_forces(mobilities, force, start_force, smoothed);
    for (const auto& mobility : mobilities)
      Kokkos::parallel_for("chebyshev_stage", vertices_of(mobility), KOKKOS_LAMBDA(const int v) {
        const Vec3<double> relaxation = mobility.velocity(v, smoothed);
        const double rate[3] = {drift(v, 0) + relaxation.x, drift(v, 1) + relaxation.y, drift(v, 2) + relaxation.z};
        for (int k = 0; k < 3; ++k) {
          const double next = x(v, k) + (stage.mu - 1) * (x(v, k) - last(v, k)) + stage.step * rate[k];
          last(v, k) = x(v, k);
          x(v, k) = next;
        }
      });
  }
}

VertexVectors vectors(const char* label, std::size_t count) { return VertexVectors(Kokkos::view_alloc(Kokkos::WithoutInitializing, std::string(label)), count); }

SurfaceMobility surface_mobility(const CellType& type, const MobilityModel& model) {
  const OneRing ring = one_ring(type.reference);
  SurfaceMobility m;
  m.mobility = model.mobility;
  m.smoothing = model.smoothing / ring.max_degree;
  m.first_vertex = type.first_vertex;
  m.count = type.count;
  m.vertices = type.vertices();
  m.degree = degrees_on_device(ring, "mobility_degree");
  m.neighbour = ring_on_device(ring, "mobility_neighbour");
  return m;
}

}  // namespace

MobilityModel mobility_model(const std::vector<CellType>& types, int delta_kernel) {
  // Mean over all offsets of sum phi^2: a sheet of forces pushes a layer 1/(this) thick.
  const double overlap = delta_kernel == 2 ? 2.0 / 3 : delta_kernel == 3 ? 0.5 : 0.375;
  double density = 0;
  for (const auto& type : types) density = std::max(density, type.vertices() / mesh_area(type.reference));
  // Measured in a dense suspension at kappa_S = 48 eta_0: a factor of 4 is stable and 3 is not. The 2-point kernel sees zigzags, so that they need a mobility too: 0.6 is unstable.
  return {5 * density * overlap, delta_kernel == 2 ? 0.4 : 0.6};
}

VertexMotion::VertexMotion(const std::vector<CellType>& types, VertexUpdate update, const MobilityModel& mobility, int interval) : update_(update), interval_(interval) {
  std::size_t vertex_count = 0;
  for (const auto& type : types) vertex_count += std::size_t(type.count) * type.vertices();
  if (keeps_velocities(update, interval)) {
    // Zeros: a checkpoint of the start has them, and equal starts have equal checkpoints.
    before_ = VertexVectors("previous_velocities", vertex_count);
    before_that_ = VertexVectors("velocities_before", vertex_count);
  }
  if (interval > 1) halfway_ = vectors("halfway_positions", vertex_count);
  if (update_ != VertexUpdate::chebyshev) return;
  for (const auto& type : types) mobilities_.push_back(surface_mobility(type, {mobility.mobility * interval, mobility.smoothing}));
  drift_ = vectors("chebyshev_drift", vertex_count);
  start_forces_ = vectors("chebyshev_forces", vertex_count);
  last_ = vectors("chebyshev_last", vertex_count);
  smoothed_ = vectors("chebyshev_smoothed", vertex_count);
}

std::size_t VertexMotion::bytes() const {
  std::size_t total = (halfway_.span() + before_.span() + before_that_.span() + drift_.span() + start_forces_.span() + last_.span() + smoothed_.span()) * sizeof(double);
  for (const auto& type : mobilities_) total += (type.degree.span() + type.neighbour.span()) * sizeof(int);
  return total;
}

std::size_t VertexMotion::bytes_per_vertex(VertexUpdate update, int interval) {
  const int vectors_kept = (keeps_velocities(update, interval) ? 2 : 0) + (interval > 1 ? 1 : 0) + (update == VertexUpdate::chebyshev ? 4 : 0);
  return std::size_t(vectors_kept) * 3 * sizeof(double);
}

VertexMotionState VertexMotion::state() const { return {steps_, stages(), to_host(before_), to_host(before_that_)}; }

void VertexMotion::restore(const VertexMotionState& state) {
  steps_ = state.steps;
  scheme_ = ChebyshevScheme(int(state.stages));
  if (before_.extent(0) == 0) return;
  Kokkos::deep_copy(before_, to_device(state.before));
  Kokkos::deep_copy(before_that_, to_device(state.before_that));
}

VertexVectors VertexMotion::halfway(const VertexVectors& positions, const VertexVectors& velocities_before) {
  if (interval_ == 1) return positions;
  const auto x = positions, u = velocities_before, there = halfway_;
  const double steps = 0.5 * interval_;
  Kokkos::parallel_for("halfway", Range(0, x.extent(0)), KOKKOS_LAMBDA(const int v) {
    for (int k = 0; k < 3; ++k) there(v, k) = x(v, k) + steps * u(v, k);
  });
  return there;
}

void VertexMotion::advance(const VertexVectors& positions, const VertexVectors& velocities, const VertexVectors& forces, const ForceOperator& compute_forces) {
  const auto x = positions, u = velocities, f = forces;
  const Range all(0, x.extent(0));
  const double steps = interval_;
  const bool averages = before_.extent(0) > 0, relaxes = update_ == VertexUpdate::chebyshev;
  if (!averages && !relaxes) {
    Kokkos::parallel_for("advance", all, KOKKOS_LAMBDA(const int v) {
      for (int k = 0; k < 3; ++k) x(v, k) += steps * u(v, k);
    });
    return;
  }
  if (averages && steps_ == 0) {
    Kokkos::deep_copy(before_, u);
    Kokkos::deep_copy(before_that_, u);
  }
  const auto u1 = before_, u2 = before_that_;
  if (relaxes && steps_ % estimate_every == 0) scheme_ = scheme_for(largest_rate(mobilities_, x, f, drift_, last_, start_forces_, compute_forces));
  const auto w = drift_, f0 = start_forces_;
  Kokkos::parallel_for("advance", all, KOKKOS_LAMBDA(const int v) {
    for (int k = 0; k < 3; ++k) {
      double mean = u(v, k);
      if (averages) {
        mean = 0.75 * u(v, k) + 0.5 * u1(v, k) - 0.25 * u2(v, k);
        u2(v, k) = u1(v, k);
        u1(v, k) = u(v, k);
      }
      if (relaxes) {
        w(v, k) = steps * mean;
        f0(v, k) = f(v, k);
      } else {
        x(v, k) += steps * mean;
      }
    }
  });
  if (relaxes) chebyshev_stages(scheme_, mobilities_, x, f, w, f0, last_, smoothed_, compute_forces);
  ++steps_;
}

void settle(const std::vector<CellType>& types, const MobilityModel& mobility, int rounds, const VertexVectors& positions, const VertexVectors& forces, const ForceOperator& compute_forces) {
  std::vector<SurfaceMobility> mobilities;
  for (const auto& type : types) mobilities.push_back(surface_mobility(type, mobility));
  const std::size_t n = positions.extent(0);
  const auto x = positions, f = forces;
  const auto last = vectors("settle_last", n), velocity = vectors("settle_velocity", n), start = vectors("settle_forces", n), smoothed = vectors("settle_smoothed", n);
  const VertexVectors none("settle_none", n);
  ChebyshevScheme scheme(1);
  for (int i = 0; i < rounds; ++i) {
    compute_forces(x, f);
    if (i % 8 == 0) scheme = scheme_for(largest_rate(mobilities, x, f, velocity, last, start, compute_forces));
    mobility_velocities(mobilities, f, none, smoothed, velocity);
    Kokkos::deep_copy(start, f);
    chebyshev_stages(scheme, mobilities, x, f, velocity, start, last, smoothed, compute_forces);  // M F(0) + M [F(s) - F(0)] = M F(s)
  }
}

}  // namespace corpuscle
