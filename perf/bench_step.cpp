// A whole coupled step: share of each operator, MLUPS, markers per second. Cells at random places with random orientations (they may overlap: no contact here).
#include <cstdio>
#include <cstdlib>
#include <string>

#include "core/best_seconds.hpp"
#include "core/random.hpp"
#include "physics/cells.hpp"
#include "physics/contact.hpp"
#include "physics/coupling.hpp"
#include "physics/fluid.hpp"
#include "physics/membrane.hpp"
#include "physics/placement.hpp"

using namespace corpuscle;

namespace {

constexpr int repeats = 5;

template <class Real>
void measure(const char* name, double phi, int points, Precision membrane_precision, double radius, int n) {
  const int size = 128;
  const Mesh mesh = red_cell_mesh(radius, n);
  CellType type;
  type.name = "red_cell";
  type.reference = mesh;
  type.moduli = {StrainLawKind::skalak, 0.01, 0.025, 0.01 * radius * radius / 405, 0.866, 1, 1};
  type.radius = radius;
  type.count = int(phi * size * size * size / mesh_volume(mesh) + 0.5);
  RandomStream random(1);
  std::vector<double> positions;
  for (int c = 0; c < type.count; ++c) {
    const Vector3 centre(random.uniform(0, size), random.uniform(0, size), random.uniform(radius, size - radius));
    const auto placed = place_mesh(mesh, centre, random_rotation(random));
    positions.insert(positions.end(), placed.begin(), placed.end());
  }
  FluidParameters p;
  p.nodes = {size, size, size};
  p.needs_force = true;
  p.halo = Coupling<Real>::halo_width(points);
  p.wall_velocity = {-0.01, 0.01};
  Fluid<Real> fluid(p);
  fluid.initialise();
  Cells cells({type}, positions);
  Coupling<Real> coupling(fluid.grid(), true, points);
  const auto membrane = make_membrane(mesh, type.moduli, membrane_precision, 0, type.count);
  const auto x = cells.positions(), F = cells.forces(), u = cells.velocities();

  const double membrane_time = best_seconds([&] { membrane->compute_forces(x, F); }, repeats);
  const double spread = best_seconds([&] { coupling.spread(x, F, fluid.force()); }, repeats);
  const double scatter = best_seconds([&] { fluid.scatter_force(); }, repeats);
  const double collide = best_seconds([&] { fluid.collide_stream(); }, repeats);
  const double gather = best_seconds([&] { fluid.gather_velocity(); }, repeats);
  const double interpolate = best_seconds([&] { coupling.interpolate(x, u, fluid.velocity()); }, repeats);
  const double total = membrane_time + spread + scatter + collide + gather + interpolate;
  const double vertices = cells.vertex_count(), nodes = double(size) * size * size;
  std::printf("  - {case: %-34s, cells: %4d, vertices: %6.0f, mlups: %5.1f, step_ms: %6.1f, collide_ms: %5.1f, halo_ms: %4.1f, spread_ms: %5.1f, interpolate_ms: %5.1f, membrane_ms: %5.1f,"
              " spread_Mps: %5.1f, interpolate_Mps: %5.1f, membrane_Mps: %5.1f}\n",
              name, type.count, vertices, nodes / total / 1e6, total * 1e3, collide * 1e3, (scatter + gather) * 1e3, spread * 1e3, interpolate * 1e3, membrane_time * 1e3,
              vertices / spread / 1e6, vertices / interpolate / 1e6, vertices / membrane_time / 1e6);
}

}  // namespace

int main(int argc, char** argv) {
  Kokkos::ScopeGuard scope(argc, argv);
  std::printf("threads: %d\nstep:\n", ExecSpace().concurrency());
  measure<float>("float phi 0.36 4-point", 0.36, 4, Precision::double_precision, 8, 8);
  measure<float>("float phi 0.36 4-point, float membrane", 0.36, 4, Precision::single_precision, 8, 8);
  measure<float>("float phi 0.36 3-point", 0.36, 3, Precision::double_precision, 8, 8);
  measure<float>("float phi 0.36 2-point", 0.36, 2, Precision::single_precision, 8, 8);
  measure<double>("double phi 0.36 4-point", 0.36, 4, Precision::double_precision, 8, 8);
  measure<float>("float phi 0.05 4-point", 0.05, 4, Precision::double_precision, 8, 8);
}
