// accuracy.coupling_every: membranes and fluid coupled every k-th step (docs/theory/model.md, Coupling every k-th step).
#include <cmath>

#include "core/kernel_log.hpp"
#include "physics/memory.hpp"
#include "tests/catch.hpp"
#include "tests/unit/running.hpp"

using namespace corpuscle;
using corpuscle::test::Running;
using corpuscle::test::start;

namespace {

std::string every(int interval) { return "coupling_every = " + std::to_string(interval) + "\n"; }

/// A capsule between sheared walls, at the same rate whatever the interval.
Running capsule(int interval) {
  return start("[box]\nsize = [4, 4, 4]\n[flow]\ncapillary_number_G = 0.3\n[accuracy]\nradius = 4\nprecision = 'double'\nshear_rate = 0.001\n" + every(interval) +
               "[run]\nstrain = 1\n[[cells]]\nshape = 'sphere'\ncount = 1\nmembrane = { law = 'neo_hookean', bending = 0 }\n");
}

/// Deformation after so many time steps.
double deformation(int interval, std::int64_t steps) {
  const Running r = capsule(interval);
  for (std::int64_t i = 0; i < steps; i += interval) r.suspension->step();
  return r.suspension->step_and_measure().mean_deformation;
}

}  // namespace

TEST_CASE("Between two couplings only the fluid works", "[coupling_interval]") {
  KernelLog log;
  const Running once = capsule(1), fourth = capsule(4);
  const auto counts = [&](const Running& r) {
    for (int i = 0; i < 3; ++i) r.suspension->step();
    log.clear();
    r.suspension->step();
    return log.counts();
  };
  const auto one = counts(once), four = counts(fourth);
  REQUIRE(one.at("collide_stream") == 1);
  for (const auto& [kernel, count] : one) {
    INFO(kernel);
    const bool of_fluid = kernel == "collide_stream" || kernel == "exchange_populations" || kernel == "bounce_back";
    CHECK(four.at(kernel) == (of_fluid ? 4 * count : count));
  }
  CHECK(four.at("halfway") == 1);
  CHECK(four.size() == one.size() + 1);
  CHECK(fourth.suspension->snapshot(false).step == 16);
  CHECK(fourth.suspension->bytes() < once.suspension->bytes());  // no velocities of earlier steps
  CHECK(double(fourth.suspension->bytes()) == Approx(double(predict_memory(fourth.problem, fourth.lattice).suspension())).epsilon(0.10));
}

TEST_CASE("A capsule deforms the same when it is coupled every second or fourth step", "[coupling_interval]") {
  // At gamma_dot = 0.001 the membrane's time is eta_0 r/G_s = 300 steps: an interval of 4 is a hundredth of it, and the scheme is of second order in the force.
  const double reference = deformation(1, 800);
  REQUIRE(reference > 0.2);
  CHECK(deformation(2, 800) == Approx(reference).epsilon(0.01));
  CHECK(deformation(4, 800) == Approx(reference).epsilon(0.01));
}

TEST_CASE("Held forces give the momentum of the sum: none in a periodic box", "[coupling_interval]") {
  const auto r = start("[box]\nsize = [4, 4, 4]\nwalls = false\n[flow]\nkind = 'rest'\n[accuracy]\nradius = 4\nprecision = 'double'\nshear_modulus = 0.02\n" + every(3) +
                       "[run]\nsteps = 100\n[[cells]]\ncount = 6\n");
  double speed = 0;
  for (int i = 0; i < 40; ++i) speed = std::max(speed, r.suspension->step_and_measure().velocity_max);
  CHECK(speed > 1e-5);
  for (const double component : r.suspension->fluid_momentum()) CHECK(std::abs(component) < 1e-16 * 4096 * 10 * speed + 1e-15);
}

TEST_CASE("The length of a run and all cadences are multiples of the interval", "[coupling_interval]") {
  const auto lattice = [](const std::string& accuracy, const std::string& cells) {
    return to_lattice(parse_scene("[box]\nsize = [3, 3, 3]\nwalls = false\n[flow]\nkind = 'rest'\n[accuracy]\nradius = 4\n" + accuracy + "[guards]\nevery = 10\n[run]\nsteps = 100\n"
                                  "[output]\nseries_every = 1\nsnapshot_every = 50\n" + cells, "test.toml"));
  };
  const auto l = lattice(every(3), "[[cells]]\ncount = 1\n");
  CHECK(l.coupling_every == 3);
  CHECK(l.steps == 102);
  CHECK(l.series_every == 3);
  CHECK(l.snapshot_every == 51);
  CHECK(l.guard_every == 12);
  CHECK(l.checkpoint_every == 0);
  CHECK(l.next_coupling(0) == 0);
  CHECK(l.next_coupling(7) == 9);
  const auto alone = lattice("", "");
  CHECK(alone.coupling_every == 1);
  CHECK(alone.steps == 100);
}
