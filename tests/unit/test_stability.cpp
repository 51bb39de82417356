// The search for a limit, the measured limits, and what a scene hears of them.
#include <cmath>

#include "core/bisect.hpp"
#include "core/error.hpp"
#include "physics/stability_limits.hpp"
#include "tests/catch.hpp"
#include "tests/complaint.hpp"

using namespace corpuscle;

namespace {

Problem red_cells() {
  Problem problem;
  problem.box.size = {6, 6, 6};
  problem.flow.capillary_number = 1e-3;
  problem.flow.reynolds_number_max = 10;  // stability is what counts here
  problem.cells.emplace_back().name = "red_cell";
  problem.cells[0].count = 1;
  return problem;
}

/// kappa_S at which the first cell type uses the given share of the stable range.
double modulus_at(Problem problem, double share) {
  problem.accuracy.shear_modulus = 1e-3;
  const auto lattice = to_lattice(problem);
  for (const auto& margin : lattice.margins)
    if (margin.name == "membrane stiffness of red_cell") return 1e-3 * share * margin.limit / margin.value;
  return 0;
}

}  // namespace

TEST_CASE("Bisection brackets a limit to the ratio asked for, with few trials, wherever the guess lies", "[stability]") {
  for (const double limit : {0.0123, 1.0, 77.0}) {
    int trials = 0;
    const auto bracket = find_limit({1, 1e-3, 1e3, 1.1}, [&](double value) { return ++trials, value < limit; });
    CHECK(bracket.good < limit);
    CHECK(bracket.bad >= limit);
    CHECK(bracket.bad / bracket.good <= 1.1);
    CHECK(bracket.limit() == Approx(limit).epsilon(0.1));
    CHECK(trials <= 12);
  }
}

TEST_CASE("Bisection says when nothing or all of the range works", "[stability]") {
  const auto none = find_limit({1, 1e-2, 1e2, 1.1}, [](double) { return false; });
  CHECK(std::isnan(none.good));
  CHECK(none.bad == 1e-2);
  CHECK(none.limit() == 0);
  const auto all = find_limit({1, 1e-2, 1e2, 1.1}, [](double) { return true; });
  CHECK(all.good == 1e2);
  CHECK(std::isinf(all.bad));
  CHECK(all.limit() == 1e2);
}

TEST_CASE("Beyond the measured limit: refused; within the margin: a warning; below: silence", "[stability]") {
  Problem problem = red_cells();
  problem.accuracy.shear_modulus = modulus_at(problem, 1.05);
  CHECK(complaint_lacks([&] { to_lattice(problem); }, {"unstable", "must be <= "}) == "");
  problem.accuracy.shear_modulus = modulus_at(problem, 0.95);
  auto lattice = to_lattice(problem);
  REQUIRE(lattice.warnings.size() == 1);
  CHECK(lattice.warnings[0].find("membrane stiffness of red_cell is at 95 % of its measured stability limit") == 0);
  problem.accuracy.shear_modulus = modulus_at(problem, 0.75);
  CHECK(to_lattice(problem).warnings.empty());
}

TEST_CASE("accuracy.allow_unstable turns a refusal into a warning", "[stability]") {
  Problem problem = red_cells();
  problem.accuracy.shear_modulus = modulus_at(problem, 1.5);
  problem.accuracy.allow_unstable = true;
  const auto lattice = to_lattice(problem);
  REQUIRE(lattice.warnings.size() == 1);
  CHECK(lattice.warnings[0].find("accuracy.allow_unstable = true") != std::string::npos);
  CHECK(lattice.cells[0].moduli.shear == *problem.accuracy.shear_modulus);
}

TEST_CASE("Bending, area and contact have limits of their own", "[stability]") {
  Problem problem = red_cells();
  problem.accuracy.shear_modulus = 0.01;
  const double eta = 1.0 / 6;
  const StiffnessLimits limits = stiffness_limits(problem.accuracy, 0);
  SECTION("bending") {
    problem.cells[0].membrane.bending = 2 * limits.bending * eta / 0.01 / 64;
    CHECK(complaint_lacks([&] { to_lattice(problem); }, {"cells.0.membrane.bending = ", "must be <= "}) == "");
  }
  SECTION("area") {
    problem.cells[0].membrane.global_area = 1e4;
    CHECK(complaint_lacks([&] { to_lattice(problem); }, {"cells.0.membrane.global_area = 10000", "must be <= "}) == "");
  }
  SECTION("contact") {
    problem.contact.strength = 2 * limits.contact * eta / 0.01;
    CHECK(complaint_lacks([&] { to_lattice(problem); }, {"contact.strength = ", "must be <= "}) == "");
  }
}

TEST_CASE("Near tau = 1/2 a Mach number beyond the fluid's limit is refused, and the offered one accepted", "[stability]") {
  Problem problem;
  problem.box.size = {4, 4, 8};
  problem.flow.reynolds_number_max = 100;
  problem.accuracy.relaxation_time = 0.51;
  problem.accuracy.mach_max = 0.3;
  CHECK(complaint_lacks([&] { to_lattice(problem); }, {"accuracy.mach_max = 0.3 is unstable", "must be <= "}) == "");
  problem.accuracy.mach_max = 0.14;
  CHECK(complaint_lacks([&] { to_lattice(problem); }, {}) == "no InputError");
}

TEST_CASE("Crowded cells that would compress the fluid beyond the guard limit the shear rate, with a large relaxation time first", "[stability]") {
  const auto chosen = [](double relaxation_time, double density = 0.2, double shear_rate = 0) {
    Problem problem = red_cells();
    problem.box.size = {5, 5, 6};
    problem.flow.capillary_number = 0.05;
    problem.flow.reynolds_number_max = 0.1;
    problem.cells[0].count.reset();
    problem.cells[0].effective_volume_fraction = 0.75;
    problem.accuracy.radius = 4;
    problem.accuracy.collision = CollisionKind::trt;
    problem.accuracy.relaxation_time = relaxation_time;
    problem.guards.density = density;
    if (shear_rate > 0) problem.accuracy.shear_rate = shear_rate;
    return to_lattice(problem);
  };
  const auto compression = [](const LatticeParameters& l) {
    return 3 * l.viscosity * l.shear_rate * crowding_pressure(l.phi_effective, l.capillary_number);
  };
  const LatticeParameters slow = chosen(1), fast = chosen(2.5);
  CHECK(slow.limits.front().name == "reynolds_number_max");
  CHECK(compression(slow) < stability_margin * 0.2);
  CHECK(fast.limits.front().name == "compression of the fluid");
  CHECK(compression(fast) == Approx(stability_margin * 0.2));
  CHECK(compression(chosen(2.5, 0.1)) == Approx(stability_margin * 0.1));
  CHECK(complaint_lacks([&] { chosen(2.5, 0.2, 1.3 * fast.shear_rate); }, {"accuracy.shear_rate", "compression of the fluid"}) == "");
  // Measured (docs/stability.md): 43 red cells, largest deviation of the density over 3 eta_0 gamma_dot.
  CHECK(crowding_pressure(0.876, 0.08) > 97);
  CHECK(crowding_pressure(0.810, 0.008) > 178);
  CHECK(crowding_pressure(0.876, 0.0008) > 631);
}

TEST_CASE("Chosen settings stay within the margin for every kernel, update and relaxation time", "[stability]") {
  Problem problem = red_cells();
  for (const auto update : {VertexUpdate::averaged, VertexUpdate::euler})
    for (const int kernel : {2, 3, 4})
      for (const double tau : {0.55, 0.6, 1.0, 2.0, 4.0}) {
        problem.accuracy.vertex_update = update;
        problem.accuracy.delta_kernel = kernel;
        problem.accuracy.relaxation_time = tau;
        const auto lattice = to_lattice(problem);
        INFO("kernel " << kernel << ", tau " << tau);
        CHECK(lattice.warnings.size() == (update == VertexUpdate::euler && kernel != 4 ? 1 : 0));  // that noise grows at any stiffness
        for (const auto& margin : lattice.margins) CHECK(margin.value <= stability_margin * margin.limit * (1 + 1e-9));
      }
}

TEST_CASE("What is coupled every k-th step has limits k times lower; settings are chosen within them, and what lies beyond is refused", "[stability]") {
  Problem problem = red_cells();
  const LatticeParameters at_every_step = to_lattice(problem);
  REQUIRE(at_every_step.limits.front().name == "membrane stability");
  const StiffnessLimits one = stiffness_limits(problem.accuracy, 0.3);
  const double response = stable_response(problem.accuracy), stable_modulus = modulus_at(problem, 0.9);
  for (const int interval : {2, 3, 8}) {
    INFO("coupled every " << interval << " steps");
    problem.accuracy.shear_modulus.reset();
    problem.accuracy.coupling_every = interval;
    const StiffnessLimits limits = stiffness_limits(problem.accuracy, 0.3);
    CHECK(limits.shear == Approx(one.shear / interval));
    CHECK(limits.bending == Approx(one.bending / interval));
    CHECK(limits.contact == Approx(one.contact / interval));
    CHECK(stable_response(problem.accuracy) == Approx(response / interval));
    const LatticeParameters lattice = to_lattice(problem);
    CHECK(lattice.shear_rate == Approx(at_every_step.shear_rate / interval));
    CHECK(lattice.warnings.empty());
    for (const auto& margin : lattice.margins) CHECK(margin.value <= stability_margin * margin.limit * (1 + 1e-9));
    problem.accuracy.shear_modulus = stable_modulus;  // of a coupling at every step
    CHECK(complaint_lacks([&] { to_lattice(problem); }, {"unstable", "must be <= "}) == "");
  }
}

TEST_CASE("Mean square curvature and mean edge of a sphere", "[stability]") {
  // (2H)^2 = 4/r^2. The discrete sum is exact for a regular mesh up to the spread of vertex areas: (max/min)^1/2 of a geodesic sphere is 1.2, its variance 1 %.
  const Mesh sphere = sphere_mesh(5, 8);
  CHECK(squared_curvature(sphere) == Approx(4.0 / 25).epsilon(0.03));
  // 3 F/2 edges; equilateral triangles of area A/F have edges sqrt(4 A/(sqrt(3) F)), unequal ones are a few per cent longer.
  CHECK(mean_edge(sphere) == Approx(std::sqrt(4 * mesh_area(sphere) / (std::sqrt(3.0) * 1280))).epsilon(0.03));
}
