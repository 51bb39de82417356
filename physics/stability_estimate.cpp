#include "physics/stability_estimate.hpp"

#include <cmath>

#include "core/random.hpp"
#include "core/vertex_vectors.hpp"
#include "physics/coupling.hpp"
#include "physics/membrane.hpp"
#include "physics/suspension.hpp"

namespace corpuscle {
namespace {

double norm(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

}  // namespace

double largest_response(const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types, const std::vector<double>& positions) {
  constexpr double difference = 1e-4;  // of positions: error 1e-8 from curvature, 1e-11 from rounding
  constexpr int iterations = 200;      // the largest eigenvalues lie close together; its value converges long before its mode
  FluidParameters parameters = fluid_parameters(problem, lattice);
  parameters.needs_force = true;
  Fluid<double> fluid(parameters);
  Coupling<double> coupling(fluid.grid(), problem.box.walls, problem.accuracy.delta_kernel);
  std::vector<std::unique_ptr<Membrane>> membranes;
  for (const auto& type : types) membranes.push_back(make_membrane(type.reference, type.moduli, Precision::double_precision, type.first_vertex, type.count));
  const VertexVectors at = to_device(positions), work("work", positions.size() / 3);
  const auto forces_at = [&](const std::vector<double>& mode, double scale) {
    std::vector<double> x = positions;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += scale * mode[i];
    const VertexVectors moved = to_device(x);
    for (const auto& membrane : membranes) membrane->compute_forces(moved, work);
    return to_host(work);
  };

  std::vector<double> mode(positions.size());
  RandomStream random(1);
  for (double& m : mode) m = random.uniform(-1, 1);
  double largest = 0;
  for (int i = 0; i < iterations; ++i) {
    const double length = norm(mode);
    for (double& m : mode) m /= length;
    const auto forward = forces_at(mode, difference), backward = forces_at(mode, -difference);
    std::vector<double> restoring(mode.size());
    for (std::size_t k = 0; k < mode.size(); ++k) restoring[k] = (backward[k] - forward[k]) / (2 * difference);
    Kokkos::deep_copy(fluid.force(), 0);
    coupling.spread(at, to_device(restoring), fluid.force());
    fluid.scatter_force();
    Kokkos::deep_copy(fluid.velocity(), fluid.force());
    fluid.gather_velocity();
    coupling.interpolate(at, work, fluid.velocity());
    mode = to_host(work);
    largest = norm(mode);
  }
  return largest;
}

}  // namespace corpuscle
