// Fluid-only speed: MLUPS, bytes a node and the fraction of the measured bandwidth of an in-place update of the same size.
#include <cstdio>
#include <cstdlib>

#include "core/lattice_for.hpp"
#include "physics/fluid.hpp"

using namespace corpuscle;

namespace {

/// x[i] = a x[i] + b: the traffic pattern of in-place streaming.
struct UpdateInPlace {
  Array1<float> x;
  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int i) const { x(i) = 0.5f * x(i) + 1.0f; }
};

/// GB/s (read + write) of an in-place update of 256 MiB, by the same loop as the lattice kernels.
double in_place_bandwidth() {
  const Grid grid{4096, 128, 128, 0};
  const UpdateInPlace body{Array1<float>("x", grid.padded_nodes())};
  double best = 0;
  for (int repeat = 0; repeat < 7; ++repeat) {
    Kokkos::fence();
    Kokkos::Timer timer;
    lattice_for("in_place", grid, interior(grid), body);
    Kokkos::fence();
    best = std::max(best, 2.0 * double(grid.nodes()) * sizeof(float) / timer.seconds() / 1e9);
  }
  return best;
}

template <class Real>
void measure(const char* name, std::array<int, 3> nodes, CollisionKind collision, bool walls, bool force, double bandwidth) {
  FluidParameters p;
  p.nodes = nodes;
  p.collision = collision;
  p.walls = walls;
  p.needs_force = force;
  p.halo = force ? 2 : 1;
  p.relaxation_time = 0.9;
  Fluid<Real> fluid(p);
  fluid.initialise();
  const double count = double(nodes[0]) * nodes[1] * nodes[2];
  const int steps = std::max(4, int(4e7 / count)) & ~1;
  double best = 1e30;
  for (int repeat = 0; repeat < 5; ++repeat) {
    Kokkos::fence();
    Kokkos::Timer timer;
    for (int i = 0; i < steps; ++i) {
      if (force) fluid.scatter_force();
      fluid.collide_stream();
      if (force) fluid.gather_velocity();
    }
    Kokkos::fence();
    best = std::min(best, timer.seconds() / steps);
  }
  const double traffic = 38 * sizeof(Real) + (force ? 12 * sizeof(Real) : 0);  // force read and cleared, velocity written
  std::printf("  - {case: %-28s, nodes: [%3d, %3d, %3d], mlups: %7.1f, bytes_per_node: %5.1f, traffic: %3.0f, bandwidth_fraction: %.2f}\n", name,
              nodes[0], nodes[1], nodes[2], count / best / 1e6, double(fluid.bytes()) / count, traffic, count / best * traffic / 1e9 / bandwidth);
}

}  // namespace

int main(int argc, char** argv) {
  Kokkos::ScopeGuard scope(argc, argv);
  const double bandwidth = in_place_bandwidth();
  std::printf("in_place_bandwidth_GB_s: %.1f\nthreads: %d\nfluid:\n", bandwidth, ExecSpace().concurrency());
  for (const auto nodes : {std::array{64, 64, 64}, std::array{128, 126, 126}, std::array{180, 90, 90}, std::array{200, 200, 200}}) {
    measure<float>("float bgk periodic", nodes, CollisionKind::bgk, false, false, bandwidth);
    measure<float>("float trt periodic", nodes, CollisionKind::trt, false, false, bandwidth);
    measure<float>("float bgk walls", nodes, CollisionKind::bgk, true, false, bandwidth);
    measure<float>("float bgk walls force", nodes, CollisionKind::bgk, true, true, bandwidth);
    measure<double>("double bgk periodic", nodes, CollisionKind::bgk, false, false, bandwidth);
    measure<double>("double bgk walls force", nodes, CollisionKind::bgk, true, true, bandwidth);
  }
}
