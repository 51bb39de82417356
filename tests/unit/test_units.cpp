// to_lattice against the paper's table (docs/theory/model.md, "Units and dimensionless numbers") and the limits on the shear rate.
#include <cmath>
#include <string>

#include "core/error.hpp"
#include "physics/stability_limits.hpp"
#include "physics/units.hpp"
#include "tests/catch.hpp"
#include "tests/refusal.hpp"

using namespace corpuscle;

namespace {

/// One red cell in the paper's fluid: r = 9, tau = 1, box 20 x 20 x 40 r.
Problem paper() {
  Problem problem;
  problem.accuracy.radius = 9;
  problem.accuracy.shell_thickness = 0.30;  // the paper's effective volume
  problem.flow.reynolds_number_max = 0.1;
  CellSpec cell;
  cell.name = "red_cell";
  cell.count = 1;
  problem.cells = {cell};
  return problem;
}

struct Column {
  double ca, shear_rate, kappa, steps_per_strain;
  double rate_digit;  ///< half of the last printed digit of the shear rate
};
const Column columns[] = {
    {0.081, 1.6e-4, 0.003, 6250, 0.05e-4},     {0.056, 1.1e-4, 0.003, 9091, 0.05e-4},       {0.028, 0.56e-4, 0.003, 17857, 0.005e-4},
    {2.8e-3, 0.056e-4, 0.003, 178571, 0.0005e-4}, {2.8e-4, 0.19e-4, 0.1, 52632, 0.005e-4}, {8.4e-5, 0.11e-4, 0.2, 90909, 0.005e-4},
    {4.2e-5, 0.056e-4, 0.2, 178571, 0.0005e-4},
};

/// Largest share of the stable range that a membrane of the scene uses.
double largest_load(const Problem& problem, const LatticeParameters& lattice) {
  double largest = 0;
  for (const auto& cell : lattice.cells)
    largest = std::max(largest, stiffness_load(stiffness_limits(problem.accuracy, lattice.phi_effective), cell.edge, cell.moduli.shear / lattice.viscosity, dilation_stiffness(cell.moduli.law, cell.moduli.shear, cell.moduli.area_dilation) / lattice.viscosity,
                                               cell.moduli.bending / lattice.viscosity));
  return largest;
}

}  // namespace

TEST_CASE("The paper's table: capillary number and shear modulus give the shear rate", "[units]") {
  for (const Column& column : columns) {
    Problem problem = paper();
    problem.flow.capillary_number = column.ca;
    problem.accuracy.shear_modulus = column.kappa;
    problem.cells[0].membrane.area_dilation = 2.5;
    const LatticeParameters lattice = to_lattice(problem);
    INFO("Ca = " << column.ca);
    CHECK(lattice.shear_rate == Approx(column.ca * column.kappa * 6 / 9).epsilon(1e-12));
    CHECK(std::abs(lattice.shear_rate - column.shear_rate) <= column.rate_digit * 1.0001);
    // The printed number of steps is 1 / printed shear rate, so it is as uncertain.
    CHECK(lattice.steps_per_strain >= 1 / (column.shear_rate + column.rate_digit) * 0.9999);
    CHECK(lattice.steps_per_strain <= 1 / (column.shear_rate - column.rate_digit) * 1.0001);
    CHECK(1 / column.shear_rate == Approx(column.steps_per_strain).epsilon(1e-4));
    CHECK(lattice.cells[0].moduli.shear == Approx(column.kappa));
    CHECK(lattice.cells[0].moduli.bending == Approx(column.kappa / 5));
    CHECK(lattice.cells[0].moduli.global_area == Approx(1));
    CHECK(lattice.cells[0].moduli.volume == Approx(1).epsilon(0.08));
    CHECK(lattice.limits.front().name == "shear_modulus");
  }
}

TEST_CASE("The paper's table: capillary number and shear rate give the shear modulus", "[units]") {
  for (const Column& column : columns) {
    Problem problem = paper();
    problem.flow.capillary_number = column.ca;
    problem.accuracy.shear_rate = column.ca * column.kappa * 6 / 9;  // the unrounded rate: the printed one exceeds the stability limit by its rounding
    const LatticeParameters lattice = to_lattice(problem);
    INFO("Ca = " << column.ca);
    CHECK(lattice.cells[0].moduli.shear == Approx(column.kappa).epsilon(1e-9));
    CHECK(lattice.limits.front().name == "shear_rate");
    CHECK(lattice.limits.front().shear_rate == lattice.shear_rate);
  }
}

TEST_CASE("Without a fixed modulus the first column follows from Re = 0.078, the stiff ones from stability", "[units]") {
  Problem problem = paper();
  problem.flow.capillary_number = 0.081;
  problem.flow.reynolds_number_max = 0.078;
  LatticeParameters lattice = to_lattice(problem);
  CHECK(lattice.limits.front().name == "reynolds_number_max");
  CHECK(lattice.shear_rate == Approx(1.605e-4).epsilon(1e-3));
  CHECK(lattice.cells[0].moduli.shear == Approx(0.003).margin(0.00005));
  CHECK(lattice.reynolds_number == Approx(0.078));
  CHECK(lattice.wall_velocity == Approx(lattice.shear_rate * 180));
  CHECK(lattice.mach_number == Approx(lattice.wall_velocity * std::sqrt(3.0)));
  CHECK(lattice.nodes == std::array<int, 3>{180, 180, 360});

  for (const double ca : {8.4e-5, 4.2e-5}) {
    problem.flow.capillary_number = ca;
    lattice = to_lattice(problem);
    CHECK(lattice.limits.front().name == "membrane stability");
    CHECK(largest_load(problem, lattice) == Approx(stability_margin));
    CHECK(lattice.cells[0].moduli.shear == Approx(lattice.viscosity * lattice.shear_rate * 9 / ca));
    CHECK(lattice.warnings.empty());
  }
  for (std::size_t i = 1; i < lattice.limits.size(); ++i) CHECK(lattice.limits[i - 1].shear_rate <= lattice.limits[i].shear_rate);

  problem.flow.capillary_number.reset();
  problem.flow.capillary_number_G = 3 * 4.2e-5;
  CHECK(to_lattice(problem).shear_rate == Approx(lattice.shear_rate));
}

TEST_CASE("The Mach limit decides in a high box", "[units]") {
  Problem problem = paper();
  problem.flow.capillary_number = 1;
  problem.flow.reynolds_number_max = 10;
  const LatticeParameters lattice = to_lattice(problem);
  CHECK(lattice.limits.front().name == "mach_max");
  CHECK(lattice.mach_number == Approx(0.1));
}

TEST_CASE("Numbers of cells for the paper's effective volume fractions", "[units]") {
  const struct { double phi; double count; } states[] = {{0.12, 1025}, {0.24, 2049}, {0.35, 2989}, {0.45, 3843}, {0.55, 4697}, {0.66, 5636}, {0.75, 6404}, {0.90, 7686}};
  Problem problem = paper();
  problem.flow.capillary_number = 0.081;
  problem.cells[0].count.reset();
  for (const auto& state : states) {
    problem.cells[0].effective_volume_fraction = state.phi;
    const LatticeParameters lattice = to_lattice(problem);
    INFO("phi_eff = " << state.phi << ": N = " << lattice.cells[0].count);
    CHECK(static_cast<double>(lattice.cells[0].count) == Approx(state.count).epsilon(0.01));
    CHECK(lattice.phi_effective == Approx(state.phi).epsilon(1e-3));
    CHECK(lattice.phi_geometric == Approx(static_cast<double>(lattice.cells[0].count) * lattice.cells[0].volume / (180. * 180 * 360)));
  }
  problem.cells[0].effective_volume_fraction.reset();
  problem.cells[0].volume_fraction = 0.3;
  CHECK(to_lattice(problem).phi_geometric == Approx(0.3).epsilon(1e-3));
}

TEST_CASE("Moduli scale with the type, the radius and the viscosity", "[units]") {
  Problem problem = paper();
  problem.flow.capillary_number = 1e-4;
  problem.accuracy.relaxation_time = 0.8;
  CellSpec stiff = problem.cells[0];
  stiff.name = "stiff";
  stiff.shape = ShapeKind::sphere;
  stiff.relative_radius = 0.5;
  stiff.relative_stiffness = 4;
  stiff.membrane.law = StrainLawKind::neo_hookean;
  stiff.membrane.volume = 3;
  problem.cells.push_back(stiff);
  const LatticeParameters lattice = to_lattice(problem);
  CHECK(lattice.viscosity == Approx(0.1));
  CHECK(largest_load(problem, lattice) == Approx(stability_margin));  // the stiffest type sits at the limit
  const double kappa = lattice.cells[0].moduli.shear;
  CHECK(lattice.cells[1].moduli.shear == Approx(4 * kappa));
  CHECK(lattice.cells[0].moduli.area_dilation == Approx(2.5 * kappa));
  CHECK(lattice.cells[1].moduli.area_dilation == 0);
  CHECK(lattice.cells[1].moduli.bending == Approx(4 * kappa * 4.5 * 4.5 / 405));
  CHECK(lattice.cells[1].moduli.volume == Approx(3 * 4 * kappa / 4.5));
  CHECK(lattice.cells[1].moduli.global_area == 0);  // a sphere couldn't deform
  CHECK(lattice.cells[0].moduli.global_area == Approx(0.6));
  CHECK(lattice.cells[1].radius == Approx(4.5));
  CHECK(lattice.cells[0].faces == 20 * 9 * 9);
  CHECK(lattice.contact_strength == Approx(kappa));

  problem.cells[0].membrane.area_dilation = 100;  // now its area modulus is what limits the rate
  const LatticeParameters dilated = to_lattice(problem);
  CHECK(dilated.limits.front().name == "membrane stability");
  CHECK(largest_load(problem, dilated) == Approx(stability_margin));
  CHECK(dilated.shear_rate < lattice.shear_rate);
}

TEST_CASE("Poiseuille, rest and flows without cells", "[units]") {
  Problem problem;
  problem.box.size = {4, 4, 10};
  problem.flow.kind = FlowKind::poiseuille;
  LatticeParameters lattice = to_lattice(problem);
  CHECK(lattice.limits.front().name == "reynolds_number_max");
  CHECK(lattice.shear_rate == Approx(0.1 / 6 / 64));
  CHECK(lattice.body_force == Approx(2 * lattice.shear_rate / 6 / 80));
  CHECK(lattice.mach_number == Approx(lattice.shear_rate * 20 * std::sqrt(3.0)));
  CHECK(lattice.capillary_number == 0);
  CHECK(lattice.contact_strength == 0);

  problem.flow.kind = FlowKind::rest;
  problem.box.walls = false;
  problem.run.steps = 1000;
  problem.cells.emplace_back().count = 1;
  lattice = to_lattice(problem);
  CHECK(lattice.shear_rate == 0);
  CHECK(lattice.steps_per_strain == 0);
  CHECK(lattice.steps == 1000);
  CHECK(lattice.limits.empty());
  CHECK(lattice.cells[0].moduli.shear == Approx(0.25 / 6));
  problem.accuracy.shear_modulus = 0.1;
  CHECK(to_lattice(problem).cells[0].moduli.shear == Approx(0.1));
}

TEST_CASE("Durations in steps", "[units]") {
  Problem problem = paper();
  problem.flow.capillary_number = 0.081;
  problem.accuracy.shear_modulus = 0.003;
  problem.run.strain = 30;
  problem.output.series_every = 1e-9;
  problem.output.snapshot_every = 0;
  LatticeParameters lattice = to_lattice(problem);
  CHECK(lattice.steps == std::llround(30 / 1.62e-4));
  CHECK(lattice.series_every == 1);
  CHECK(lattice.snapshot_every == 0);
  problem.run.steps = 5000000000;  // beyond 32 bits
  CHECK(to_lattice(problem).steps == 5000000000);
}

TEST_CASE("The relaxation time of fewest steps: 2 where the Reynolds number decides, less where stiffness does", "[units]") {
  const auto steps = [](Problem problem, double tau) {
    problem.accuracy.relaxation_time = tau;
    return to_lattice(problem).steps_per_strain;
  };
  Problem problem = paper();
  problem.flow.capillary_number = 0.081;
  CHECK(relaxation_time_of_fewest_steps(problem) == 2);
  bool between = false;
  for (const double ca : {0.02, 0.01, 0.005, 0.002, 0.001, 1e-4}) {
    problem.flow.capillary_number = ca;
    const double chosen = relaxation_time_of_fewest_steps(problem);
    CAPTURE(ca, chosen);
    for (int tenths = 10; tenths <= 20; ++tenths) CHECK(steps(problem, chosen) <= steps(problem, tenths / 10.0) * (1 + 1e-12));
    between = between || (chosen > 1 && chosen < 2);
  }
  CHECK(between);
  CHECK(relaxation_time_of_fewest_steps(problem) == 1);
}

TEST_CASE("The relaxation time of fewest steps passes over those that a given modulus is too stiff for", "[units]") {
  Problem problem = paper();
  problem.flow.capillary_number = 0.001;
  const auto allowed = [&](double tau) {
    problem.accuracy.relaxation_time = tau;
    return refusal(problem) == "accepted";
  };
  problem.accuracy.shear_modulus = 0.1;
  CHECK(relaxation_time_of_fewest_steps(problem) == 1);  // the less viscous the fluid, the faster the flow of this capillary number
  problem.accuracy.shear_modulus = 0.3;
  REQUIRE_FALSE(allowed(2));
  REQUIRE(allowed(1));
  CHECK(allowed(relaxation_time_of_fewest_steps(problem)));
  problem.accuracy.shear_modulus = 9;
  CHECK(relaxation_time_of_fewest_steps(problem) == 2);
}

TEST_CASE("Both of shear modulus and shear rate state the capillary number", "[units]") {
  Problem problem = paper();
  problem.accuracy.shear_modulus = 0.003;
  problem.accuracy.shear_rate = 1.62e-4;
  CHECK(to_lattice(problem).capillary_number == Approx(0.081));
}

TEST_CASE("What a message offers as the nearest allowed value is accepted", "[units]") {
  const auto offered = [](const std::string& message) { return std::stod(message.substr(message.find("must be <= ") + 11)); };
  Problem problem = paper();
  problem.flow.capillary_number = 0.081;

  problem.accuracy.shear_modulus = 0.1;
  std::string message = refusal(problem);
  CHECK(mentions(message, "reynolds_number_max"));
  problem.accuracy.shear_modulus = offered(message);
  CHECK(refusal(problem) == "accepted");

  problem.flow.capillary_number = 1e-4;
  problem.accuracy.shear_modulus = 5;
  message = refusal(problem);
  CHECK(mentions(message, "accuracy.shear_modulus = 5 is unstable"));
  problem.accuracy.shear_modulus = offered(message);
  CHECK(refusal(problem) == "accepted");

  problem.flow.capillary_number = 1e-4;
  problem.accuracy.shear_modulus = 0.2;
  problem.cells[0].membrane.area_dilation = 50;
  message = refusal(problem);
  CHECK(mentions(message, "cells.0.membrane.area_dilation = 50"));
  problem.cells[0].membrane.area_dilation = offered(message);
  CHECK(refusal(problem) == "accepted");

  problem.accuracy.shear_modulus.reset();
  problem.accuracy.shear_rate = 1e-4;
  message = refusal(problem);
  CHECK(mentions(message, "accuracy.shear_rate = 0.0001"));
  problem.accuracy.shear_rate = offered(message);
  CHECK(refusal(problem) == "accepted");
}

TEST_CASE("A volume force that would outrun sound limits the shear rate, and is refused when the modulus is fixed", "[units]") {
  Problem problem = paper();
  problem.accuracy.radius = 6;
  problem.flow.capillary_number = 0.01;
  problem.flow.reynolds_number_max = 1;
  problem.accuracy.mach_max = 0.3;
  problem.cells[0].membrane.volume = 3000;
  const auto lattice = to_lattice(problem);
  CHECK(lattice.limits.front().name == "volume stability");
  const auto& cell = lattice.cells[0];
  CHECK(cell.moduli.volume * cell.area / (2 * std::sqrt(1.0 / 3) * cell.volume) == Approx(stability_margin * stable_response(problem.accuracy)));
  problem.accuracy.shear_modulus = 0.01;
  try {
    to_lattice(problem);
    FAIL("accepted");
  } catch (const InputError& error) {
    CHECK(std::string(error.what()).find("cells.0.membrane.volume = 3000 is unstable") == 0);
  }
}
