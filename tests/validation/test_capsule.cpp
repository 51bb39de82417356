// A spherical capsule in shear: small deformation theory and the boundary-element reference.
#include <cmath>

#include "io/scene.hpp"
#include "physics/packing.hpp"
#include "physics/statistics/ellipsoid.hpp"
#include "physics/suspension.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

namespace {

struct CapsuleResult {
  double deformation, inclination, intrinsic_viscosity, wall_intrinsic_viscosity;
};

CapsuleResult run_capsule(const std::string& overrides, double strain) {
  const std::string scene = "[run]\nstrain = 1000\n[[cells]]\nshape = 'sphere'\ncount = 1\n" + overrides;
  const Problem problem = parse_scene(scene, "capsule.toml");
  const LatticeParameters lattice = to_lattice(problem);
  const auto types = make_cell_types(problem, lattice);
  const auto suspension = make_suspension(problem, lattice, types, place_cells(problem, lattice, types));
  const auto steps = std::int64_t(strain * lattice.steps_per_strain);
  for (std::int64_t i = 0; i < steps; ++i) suspension->step();
  const Sample sample = suspension->step_and_measure();
  const auto fit = statistics::fit_ellipsoid(sample.cells[0].gyration);
  return {fit.deformation, fit.inclination, (sample.relative_viscosity - 1) / lattice.phi_geometric,
          (sample.wall_relative_viscosity - 1) / lattice.phi_geometric};
}

}  // namespace

TEST_CASE("Small deformation of a capsule: D = 25/12 Ca_G for neo-Hookean and Skalak C = 1", "[capsule]") {
  // Errors: second order in Ca_G (the boundary-element value at 0.0375 lies 0.4 % above the line, at 0.02 it is less), resolution (1 % with a mesh that lies a shell inside of the radius,
  // docs/accuracy.md), periodic images and walls at a distance of 5 radii (of the order of (r/5r)^3 = 1 %), Re = 0.05.
  const std::string flow = "bending = 0 }\n[flow]\ncapillary_number_G = 0.02\nreynolds_number_max = 0.05\n[box]\nsize = [10, 10, 10]\n[accuracy]\nradius = 6\ncell_size = 'hydrodynamic'\n";
  const double theory = 25.0 / 12 * 0.02;
  const auto nh = run_capsule("membrane = { law = 'neo_hookean', " + flow, 1.0);
  const auto sk = run_capsule("membrane = { law = 'skalak', area_dilation = 1, " + flow, 1.0);
  UNSCOPED_INFO("NH D/theory = " << nh.deformation / theory << ", angle " << nh.inclination << ", [eta] " << nh.intrinsic_viscosity);
  UNSCOPED_INFO("SK D/theory = " << sk.deformation / theory << ", angle " << sk.inclination << ", [eta] " << sk.intrinsic_viscosity);
  CHECK(nh.deformation == Approx(theory).epsilon(0.03));
  CHECK(sk.deformation == Approx(theory).epsilon(0.03));
  CHECK(sk.deformation == Approx(nh.deformation).epsilon(0.02));
}

TEST_CASE("Particle stress equals wall stress in steady shear, for every kernel", "[capsule]") {
  // Steady momentum balance: sigma_wall = eta_0 shear_rate + particle stress, exact for any discretisation once start-up has decayed. The channel's slowest mode decays with
  // H^2/(pi^2 nu) = 350 steps, the capsule's shape with about one strain unit; after 4 units 1 % of the excess is left, and rounding in single precision is below that.
  for (const char* kernel : {"2", "3", "4"}) {
    const auto r = run_capsule(std::string("membrane = { law = 'skalak', area_dilation = 1, bending = 0 }\n[flow]\ncapillary_number_G = 0.05\nreynolds_number_max = 0.1\n[box]\n"
                                           "size = [6, 6, 6]\n[accuracy]\nprecision = 'double'\nradius = 4\ndelta_kernel = ") + kernel + "\n", 4.0);
    INFO(kernel << "-point kernel");
    CHECK(r.wall_intrinsic_viscosity == Approx(r.intrinsic_viscosity).epsilon(0.02));
  }
}

TEST_CASE("Moving vertices with a mean of velocities changes a capsule's shape by less than 0.1 %", "[capsule]") {
  // Euler steps lag by less than a step of 1/(shear rate) = 5000 steps: relative changes of the order of 1e-4.
  const std::string flow = "membrane = { law = 'neo_hookean', bending = 0 }\n[flow]\ncapillary_number_G = 0.1\nreynolds_number_max = 0.05\n[box]\nsize = [6, 6, 6]\n[accuracy]\nradius = 4\n"
                           "delta_kernel = 4\nvertex_update = ";
  const auto averaged = run_capsule(flow + "'averaged'\n", 1.0), euler = run_capsule(flow + "'euler'\n", 1.0);
  CHECK(averaged.deformation == Approx(euler.deformation).epsilon(1e-3));
  CHECK(averaged.intrinsic_viscosity == Approx(euler.intrinsic_viscosity).epsilon(1e-3));
}
