// The state of a suspension: going on from it gives the same bits as never having stopped.
#include <cmath>

#include "io/scene.hpp"
#include "physics/packing.hpp"
#include "physics/suspension.hpp"
#include "tests/catch.hpp"
#include "tests/unit/running.hpp"

using namespace corpuscle;
using corpuscle::test::Running;
using corpuscle::test::start;

namespace {

/// Takes the state, loses all else, and goes on in a new suspension.
Running go_on_elsewhere(const std::string& scene, const Suspension& from) {
  Running r = start(scene);
  for (int i = 0; i < 3; ++i) r.suspension->step();  // what it did before must not matter
  r.suspension->restore(from.state(), [&](int direction) { return from.population(direction); });
  return r;
}

/// Whether two suspensions are in the same state, bit for bit, and measure the same.
void check_equal(Suspension& a, Suspension& b) {
  const auto x = a.snapshot(true), y = b.snapshot(true);
  CHECK(x.step == y.step);
  CHECK(x.positions == y.positions);
  CHECK(x.velocities == y.velocities);
  CHECK(x.fluid_velocity == y.fluid_velocity);
  int different = 0;
  for (int q = 0; q < 19; ++q) different += a.population(q) != b.population(q);
  CHECK(different == 0);
  const Sample s = a.step_and_measure(), t = b.step_and_measure();
  CHECK(s.particle_stress == t.particle_stress);
  CHECK((s.wall_shear_stress == t.wall_shear_stress || std::isnan(s.wall_shear_stress[0])));
}

const std::string two_cells = "[[cells]]\ncount = 1\nposition = [1.2, 1.6, 1.3]\n"
    "[[cells]]\nshape = 'sphere'\ncount = 1\nposition = [1.4, 1.7, 2.3]\nrelative_radius = 0.5\n";
const std::string sheared = "[box]\nsize = [3, 3, 3.5]\n[flow]\ncapillary_number = 0.05\n" + two_cells;

}  // namespace

TEST_CASE("A suspension goes on bit for bit from its state, at odd and even steps and with every vertex update", "[suspension][checkpoint]") {
  for (const char* update : {"averaged", "chebyshev", "euler"})
    for (const char* precision : {"single", "double"})
      for (const int steps : {0, 1, 70, 71}) {
        INFO(update << ", " << precision << " precision, " << steps << " steps");
        const std::string scene = sheared + "[accuracy]\nradius = 4\nvertex_update = '" + update + "'\nprecision = '" + precision + "'\n[run]\nsteps = 200\n";
        auto without_pause = start(scene);
        for (int i = 0; i < steps; ++i) without_pause.suspension->step();
        auto resumed = go_on_elsewhere(scene, *without_pause.suspension);
        check_equal(*without_pause.suspension, *resumed.suspension);
        for (int i = 0; i < 67; ++i) {  // across the chebyshev update's next estimate of the stiffness
          without_pause.suspension->step();
          resumed.suspension->step();
        }
        check_equal(*without_pause.suspension, *resumed.suspension);
      }
}

TEST_CASE("A suspension that is coupled every third step goes on bit for bit from its state, at odd and even steps", "[suspension][checkpoint]") {
  for (const char* update : {"averaged", "chebyshev"})
    for (const int couplings : {0, 1, 22}) {
      INFO(update << ", " << couplings << " couplings");
      const std::string scene = sheared + "[accuracy]\nradius = 4\ncoupling_every = 3\nvertex_update = '" + update + "'\n[run]\nsteps = 200\n";
      auto without_pause = start(scene);
      for (int i = 0; i < couplings; ++i) without_pause.suspension->step();
      CHECK(without_pause.suspension->state().step == 3 * couplings);
      auto resumed = go_on_elsewhere(scene, *without_pause.suspension);
      for (int i = 0; i < 23; ++i) {
        without_pause.suspension->step();
        resumed.suspension->step();
      }
      check_equal(*without_pause.suspension, *resumed.suspension);
    }
}

TEST_CASE("A fluid without walls, a channel flow and a cell that is stretched go on bit for bit", "[suspension][checkpoint]") {
  for (const char* scene :
       {"[box]\nsize = [2, 2, 4]\n[flow]\nkind = 'poiseuille'\n[accuracy]\nradius = 5\n[run]\nstrain = 1\n",
        "[box]\nsize = [3, 3, 3]\nwalls = false\n[flow]\nkind = 'rest'\n[accuracy]\nradius = 4\ndelta_kernel = 4\n[run]\nsteps = 99\n"
        "[[cells]]\nshape = 'sphere'\ncount = 1\n"
        "stretch = { force = 0.5, patch_diameter = 0.8 }\n"}) {
    auto without_pause = start(scene);
    for (int i = 0; i < 33; ++i) without_pause.suspension->step();
    auto resumed = go_on_elsewhere(scene, *without_pause.suspension);
    for (int i = 0; i < 34; ++i) {
      without_pause.suspension->step();
      resumed.suspension->step();
    }
    check_equal(*without_pause.suspension, *resumed.suspension);
  }
}

TEST_CASE("A state of one precision opens in the other; a run in single precision loses nothing on the way through double", "[suspension][checkpoint]") {
  const auto scene = [](const char* precision) { return sheared + "[accuracy]\nradius = 4\nprecision = '" + precision + "'\n[run]\nsteps = 200\n"; };
  auto single = start(scene("single"));
  for (int i = 0; i < 41; ++i) single.suspension->step();
  auto in_double = go_on_elsewhere(scene("double"), *single.suspension);
  auto back = go_on_elsewhere(scene("single"), *in_double.suspension);
  check_equal(*single.suspension, *back.suspension);
  // Both follow the same equations: after some steps they differ by what rounding in single precision, 6e-8 of populations of the size of velocities of 0.03,
  // adds up to.
  for (int i = 0; i < 20; ++i) {
    single.suspension->step();
    in_double.suspension->step();
  }
  in_double.suspension->step();  // `check_equal` has taken one step with the other
  const auto x = single.suspension->snapshot(false).positions, y = in_double.suspension->snapshot(false).positions;
  double difference = 0;
  for (std::size_t i = 0; i < x.size(); ++i) difference = std::max(difference, std::abs(x[i] - y[i]));
  CHECK(difference > 0);
  CHECK(difference < 1e-4);
}
