#include "physics/suspension.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "io/scene.hpp"
#include "physics/contact_patches.hpp"
#include "physics/memory.hpp"
#include "physics/packing.hpp"
#include "tests/catch.hpp"
#include "tests/contains.hpp"
#include "tests/unit/running.hpp"

using namespace corpuscle;
using corpuscle::test::Running;
using corpuscle::test::start;

namespace {

const std::string fluid_only = "[box]\nsize = [2, 2, 4]\n[accuracy]\nradius = 5\n[run]\nstrain = 1\n";

}  // namespace

TEST_CASE("A stretched cell in a periodic fluid at rest grows along the force, gains no momentum, and its stress leaves the external force out", "[suspension]") {
  const auto r = start("[box]\nsize = [4, 4, 4]\nwalls = false\n[flow]\nkind = 'rest'\n[accuracy]\nradius = 4\nprecision = 'double'\nshear_modulus = 0.02\n[run]\nsteps = 4000\n[[cells]]\nshape = 'sphere'\n"
                       "count = 1\nstretch = { force = 0.5, patch_diameter = 0.8 }\n");
  Sample sample;
  for (int i = 0; i < 4000; ++i) sample = r.suspension->step_and_measure();
  const auto& cell = sample.cells[0];
  CHECK(cell.extent[0] > 8.5);
  CHECK(cell.extent[1] < 7.9);
  CHECK(cell.extent[1] == Approx(cell.extent[2]).epsilon(0.01));  // the icosahedron is not isotropic about x
  for (const double component : r.suspension->fluid_momentum()) CHECK(std::abs(component) < 1e-12);
  // In equilibrium membrane and external forces balance up to a pressure, whose first moment is isotropic: the membrane's is that of the external force, F times the distance
  // of the patches' means. It relaxes with a few times eta r/G_s = 100 steps: a few per mille are left.
  const CellType type = make_cell_types(r.problem, r.lattice)[0];
  const ContactPatches patches = contact_patches(type.reference, {1, 0, 0}, 0.8 * 4);
  const auto x = r.suspension->snapshot(false).positions;
  double distance = 0;
  for (const int v : patches.ahead) distance += x[3 * v] / double(patches.ahead.size());
  for (const int v : patches.behind) distance -= x[3 * v] / double(patches.behind.size());
  CHECK(cell.stresslet[0] - 0.5 * (cell.stresslet[4] + cell.stresslet[8]) == Approx(0.5 * 0.02 * 4 * distance).epsilon(0.01));
}

TEST_CASE("A scene allocates only what it needs, and as much as predicted", "[suspension]") {
  const auto fluid = start(fluid_only);
  const double nodes = double(fluid.lattice.nodes[0]) * fluid.lattice.nodes[1] * fluid.lattice.nodes[2];
  CHECK(double(fluid.suspension->bytes()) < nodes * 19 * 4 * std::pow(1.2, 3) + 19 * 4096);
  const auto cells = start("[box]\nsize = [6, 6, 6]\n[flow]\ncapillary_number = 0.1\n[accuracy]\nradius = 6\n[run]\nstrain = 1\n[[cells]]\ncount = 20\n");
  cells.suspension->step();
  CHECK(double(cells.suspension->bytes()) == Approx(double(predict_memory(cells.problem, cells.lattice).suspension())).epsilon(0.10));
}

TEST_CASE("Momentum of a periodic suspension at rest stays zero to round-off", "[suspension]") {
  // Membrane and contact forces are internal: whatever the cells do, the fluid's total momentum does not change.
  const auto r = start("[box]\nsize = [4, 4, 4]\nwalls = false\n[flow]\nkind = 'rest'\n[accuracy]\nradius = 4\nprecision = 'double'\nshear_modulus = 0.02\n[run]\nsteps = 100\n[[cells]]\ncount = 6\n");
  double speed = 0;
  for (int i = 0; i < 100; ++i) {
    const Sample sample = r.suspension->step_and_measure();
    speed = std::max(speed, sample.velocity_max);
  }
  CHECK(speed > 1e-5);  // the packed cells do move
  // 4096 nodes, 100 steps and a force of 6 x 162 vertices per step, each rounded to 1e-16 of a momentum of the order of the speed.
  for (const double component : r.suspension->fluid_momentum()) CHECK(std::abs(component) < 1e-16 * 4096 * 10 * speed + 1e-15);
}

TEST_CASE("A red cell at rest stays as it is", "[suspension]") {
  const auto r = start("[box]\nsize = [4, 4, 4]\nwalls = false\n[flow]\nkind = 'rest'\n[accuracy]\nradius = 4\nprecision = 'double'\n[run]\nsteps = 100\n[[cells]]\ncount = 1\n");
  const auto before = r.suspension->snapshot(false);
  for (int i = 0; i < 200; ++i) r.suspension->step();
  const auto after = r.suspension->snapshot(false);
  double moved = 0;
  for (std::size_t i = 0; i < before.positions.size(); ++i) moved = std::max(moved, std::abs(after.positions[i] - before.positions[i]));
  CHECK(moved < 1e-10);
}

TEST_CASE("A run that blows up is stopped with the cell, the step and what to do", "[suspension]") {
  auto r = start("[box]\nsize = [4, 4, 4]\n[flow]\ncapillary_number = 0.1\n[accuracy]\nradius = 4\n[run]\nstrain = 1\n[[cells]]\nshape = 'sphere'\ncount = 1\n");
  // Beyond every stability limit: the same scene with a membrane a thousand times too stiff.
  auto lattice = r.lattice;
  lattice.cells[0].moduli.shear *= 1000;
  lattice.cells[0].moduli.area_dilation *= 1000;
  const auto types = make_cell_types(r.problem, lattice);
  auto positions = place_cells(r.problem, lattice, types);
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] *= 1 + 0.02 * std::sin(double(i));
  const auto broken = make_suspension(r.problem, lattice, types, positions);
  std::string message;
  try {
    for (int i = 0; i < 500; ++i) {
      broken->step();
      broken->check();
    }
  } catch (const SimulationError& error) {
    message = error.what();
  }
  INFO(message);
  CHECK(message.find("The guard on ") == 0);
  CHECK(message.find("cell 0 (sphere)") != std::string::npos);
  CHECK(message.find("shear_modulus") != std::string::npos);
}

TEST_CASE("The guards see forces and contact of a start, and looking changes nothing", "[suspension][guards]") {
  const std::string scene = "[box]\nsize = [6, 4, 4]\n[flow]\ncapillary_number = 0.05\n[accuracy]\nradius = 4\n[run]\nsteps = 20\n"
                            "[[cells]]\nshape = 'sphere'\ncount = 1\nposition = [1.5, 2, 2]\n[[cells]]\nshape = 'sphere'\ncount = 1\nposition = [4, 2, 2]\n";
  const auto looked_at = start(scene), left_alone = start(scene);
  for (int i = 0; i < 20; ++i) {
    if (i == 0) looked_at.suspension->check();
    looked_at.suspension->step();
    left_alone.suspension->step();
  }
  CHECK(looked_at.suspension->snapshot(false).positions == left_alone.suspension->snapshot(false).positions);

  const auto types = make_cell_types(looked_at.problem, looked_at.lattice);
  const auto healthy = place_cells(looked_at.problem, looked_at.lattice, types);
  const auto complaint = [&](const std::vector<double>& positions) {
    const auto suspension = make_suspension(looked_at.problem, looked_at.lattice, types, positions);
    try {
      suspension->check();
    } catch (const SimulationError& broken) {
      return std::string(broken.what());
    }
    return std::string();
  };
  CHECK(complaint(healthy) == "");
  const std::size_t one_cell = 3 * std::size_t(types[0].vertices());
  auto pierced = healthy;
  for (std::size_t i = 0; i < one_cell; i += 3) pierced[i] += 4;  // of the 10 between the centres, which are 8 apart when the cells touch
  CHECK_THAT(complaint(pierced), Contains("The guard on contact stopped the run before step 0"));
  auto infinite = healthy;
  for (std::size_t i = 0; i < one_cell; ++i) infinite[i] *= 1e120;
  CHECK_THAT(complaint(infinite), Contains("The guard on numbers stopped the run before step 0"));
}
