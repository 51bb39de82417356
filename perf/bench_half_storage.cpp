// What 16 bits for stored populations would do to a plane shear flow: populations are rounded after each step as if they were stored so (docs/accuracy.md has the table).
// usage: bench_half_storage
// The format is that of FluidX3D (Lehmann et al., Phys. Rev. E 106, 015308 (2022), "FP16S"): IEEE half precision of 2^15 (f_i - w_i), arithmetic in single precision.
#include <fmt/format.h>

#include <Kokkos_Core.hpp>
#include <cmath>
#include <vector>

#include "physics/fluid.hpp"

using namespace corpuscle;

namespace {

/// x on the grid of numbers that 16 bits hold: 11 bits of mantissa, exponents from -14 - 15 on, gradual underflow.
float through_half(float x) {
  if (x == 0) return 0;
  int exponent;
  std::frexp(x, &exponent);
  const int last = std::max(exponent - 11, -24 - 15);
  return float(std::ldexp(std::nearbyint(std::ldexp(double(x), -last)), last));
}

void round_populations(Fluid<float>& fluid) {
  std::vector<std::vector<float>> populations;
  for (int q = 0; q < 19; ++q) {
    populations.push_back(fluid.population(q));
    for (float& g : populations.back()) g = through_half(g);
  }
  fluid.restore(fluid.step(), [&](int q) { return populations[q]; });
}

struct Deviation {
  double stress = 0;         ///< mean of the wall stress over eta gamma_dot, less 1
  double scatter = 0;        ///< standard deviation of the same from step to step
  double velocity = 0;       ///< largest deviation from the linear profile at the end, over the wall's velocity
};

Deviation measure(double relaxation_time, double reynolds_number, bool rounded) {
  constexpr int radius = 8, gap = 6 * radius, steps = 12000, settled = 4000;
  FluidParameters p;
  p.nodes = {4, 4, gap};
  p.relaxation_time = relaxation_time;
  p.collision = CollisionKind::trt;
  const double viscosity = (relaxation_time - 0.5) / 3, rate = reynolds_number * viscosity / (radius * radius);
  p.wall_velocity = {-0.5 * rate * gap, 0.5 * rate * gap};
  Fluid<float> fluid(p);
  fluid.initialise();
  double sum = 0, squares = 0;
  for (int step = 0; step < steps; ++step) {
    if (rounded) round_populations(fluid);
    fluid.collide_stream();
    if (step < settled) continue;
    const auto stress = fluid.wall_shear_stress();
    const double relative = 0.5 * (stress[0] + stress[1]) / (viscosity * rate) - 1;
    sum += relative, squares += relative * relative;
  }
  Deviation d;
  d.stress = sum / (steps - settled);
  d.scatter = std::sqrt(std::max(0.0, squares / (steps - settled) - d.stress * d.stress));
  const auto velocity = fluid.velocity_host_double();
  for (int z = 0; z < gap; ++z)
    d.velocity = std::max(d.velocity, std::abs(velocity[3 * 16 * z] - (p.wall_velocity[0] + rate * (z + 0.5))) / p.wall_velocity[1]);
  return d;
}

}  // namespace

int main(int argc, char* argv[]) {
  const Kokkos::ScopeGuard kokkos(argc, argv);
  fmt::print("Shear flow of a scene with r = 8 and walls 6 r apart, TRT; Re = 0.01 and 0.001 stand for stiff cells, which set the rate.\n\n");
  fmt::print("| stored | tau | Re | wall stress, mean deviation | scatter from step to step | velocity, largest deviation |\n|---|---|---|---|---|---|\n");
  for (const double relaxation_time : {1.0, 2.0})
    for (const double reynolds_number : {0.1, 0.01, 0.001})
      for (const bool rounded : {false, true}) {
        const Deviation d = measure(relaxation_time, reynolds_number, rounded);
        fmt::print("| {} | {:g} | {:g} | {:+.3g} % | {:.2g} % | {:.2g} % |\n", rounded ? "16 bits" : "32 bits", relaxation_time, reynolds_number, 100 * d.stress, 100 * d.scatter,
                   100 * d.velocity);
      }
}
