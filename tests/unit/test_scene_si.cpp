// Values with units: text to quantity, quantity to dimensionless key, lattice units back to SI. Numbers computed by hand.
#include <cmath>

#include "core/error.hpp"
#include "io/quantity.hpp"
#include "io/scene.hpp"
#include "physics/units.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

namespace {

// kappa_S = 3 G_s = 15 uN/m, kappa_S r = 60 pN, kappa_S r^2 = 2.4e-16 J, eta_0 r/kappa_S = 0.32 ms.
const std::string scales = "[si]\nradius = '4 um'\nviscosity = '1.2 mPa s'\nshear_modulus = 5e-6\n";
const std::string rest = "[box]\nsize = ['24 um', 6, 6]\nwalls = false\n[flow]\nkind = 'rest'\n[run]\nduration = '32 ms'\n";
const std::string cell = "[[cells]]\ncount = 1\n";

void check_quantity(const char* text, double value, Dimension dimension) {
  INFO(text);
  const auto q = parse_quantity(text);
  REQUIRE(q);
  CHECK(q->value == Approx(value).epsilon(1e-14));
  CHECK(q->dimension == dimension);
}

std::string message(const std::string& scene, const std::vector<std::string>& overrides = {}) {
  try {
    to_lattice(parse_scene(scene, "s.toml", overrides));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("Quantities are read with prefixes, products, quotients and exponents", "[si]") {
  check_quantity("3.91 um", 3.91e-6, {0, 1, 0});
  check_quantity("3.91 \u00b5m", 3.91e-6, {0, 1, 0});
  check_quantity("3.91\u03bcm", 3.91e-6, {0, 1, 0});
  check_quantity("67.7 pN", 67.7e-12, {1, 1, -2});
  check_quantity("2e-19 J", 2e-19, {1, 2, -2});
  check_quantity("1.2 mPa s", 1.2e-3, {1, -1, -1});
  check_quantity("1.2 mPa*s", 1.2e-3, {1, -1, -1});
  check_quantity("1.2 mPa\u00b7s", 1.2e-3, {1, -1, -1});
  check_quantity("1.2 cP", 1.2e-3, {1, -1, -1});
  check_quantity("5.3 uN/m", 5.3e-6, {1, 0, -2});
  check_quantity("6e-3 dyn/cm", 6e-6, {1, 0, -2});
  check_quantity("100 1/s", 100, {0, 0, -1});
  check_quantity("100 s^-1", 100, {0, 0, -1});
  check_quantity("100/s", 100, {0, 0, -1});
  check_quantity("2 kg m^2 / s^2", 2, {1, 2, -2});
  check_quantity("2 g m^-1 s^-2", 2e-3, {1, -1, -2});
  check_quantity(" 5 m ", 5, {0, 1, 0});  // metre, not milli
  check_quantity("5 mm", 5e-3, {0, 1, 0});
  CHECK(parse_quantity("5 uN/m")->value == 5e-6);  // exactly: merged scenes stay readable
  CHECK(parse_quantity("3.91 um")->value == 3.91e-6);
  for (const char* none : {"", "um", "5", "5 5 m", "5 parsec", "5 m/s/s", "5 m^", "5 m^x", "5 m^99", "big", "inf m", "nan m", "5 m//s", "1e999 m", "5 /"}) {
    INFO(none);
    CHECK_FALSE(parse_quantity(none));
  }
}

TEST_CASE("SI values become the dimensionless keys", "[si]") {
  const std::string first = "[[cells]]\ncount = 1\nposition = ['8 um', 3, 3]\nmembrane = { bending = '2.4e-19 J', global_area = '3 mN/m' }\n"
                            "stretch = { force = '30 pN', patch_diameter = '2 um' }\n";
  const std::string second = "[[cells]]\nshape = 'sphere'\ncount = 1\nposition = [5, 5, 5]\nmembrane = { bending = '2.4e-19 J' }\nrelative_radius = '2 um'\n"
                             "relative_stiffness = '10 uN/m'\nstretch = { force = '60 pN', patch_diameter = '1 um' }\n";
  const Problem p = parse_scene(scales + rest + first + second + "[output]\nseries_every = '3.2 ms'\n", "s.toml");
  CHECK(p.box.size[0] == Approx(6));
  CHECK(p.box.size[1] == 6);
  CHECK(p.run.duration.value() == Approx(100));
  CHECK(p.output.series_every == Approx(10));
  CHECK(p.output.snapshot_every == Approx(10));  // a tenth of the run
  CHECK((*p.cells[0].position)[0] == Approx(2));
  CHECK(p.cells[0].membrane.bending == Approx(1e-3));
  CHECK(p.cells[0].membrane.global_area.value() == Approx(200));
  CHECK(p.cells[0].stretch.force.value() == Approx(0.5));
  CHECK(p.cells[0].stretch.patch_diameter == Approx(0.5));
  // Moduli are relative to kappa_S = 30 uN/m and r = 2 um of the type, wherever its size and stiffness stand.
  CHECK(p.cells[1].relative_radius == Approx(0.5));
  CHECK(p.cells[1].relative_stiffness == Approx(2));
  CHECK(p.cells[1].membrane.bending == Approx(2e-3));
  CHECK(p.cells[1].stretch.force.value() == Approx(1));
  CHECK(p.cells[1].stretch.patch_diameter == Approx(0.5));
}

TEST_CASE("A physical shear rate becomes a capillary number", "[si]") {
  const std::string shear = scales + "shear_rate = '250 1/s'\n[output]\nseries_every = '0.2 ms'\n" + cell;
  const Problem p = parse_scene(shear, "s.toml");
  CHECK(p.flow.capillary_number.value() == Approx(1.2e-3 * 250 * 4e-6 / 15e-6));  // 0.08
  CHECK_FALSE(p.si.shear_rate);
  CHECK(p.output.series_every == Approx(0.05));
  const LatticeParameters lattice = to_lattice(p);
  CHECK(lattice.shear_rate / *lattice.si.time == Approx(250));
  const Problem by_ca = parse_scene(scales + "[flow]\ncapillary_number_G = 0.24\n[output]\nseries_every = '0.2 ms'\n" + cell, "s.toml");
  CHECK(by_ca.output.series_every == Approx(0.05));
  // An override replaces the other way to say it.
  CHECK(parse_scene(shear, "s.toml", {"flow.capillary_number=0.01", "output.series_every=0.1"}).flow.capillary_number == 0.01);
  CHECK(parse_scene(to_toml(p), "s.toml", {"si.shear_rate=125 1/s"}).flow.capillary_number.value() == Approx(0.04));
}

TEST_CASE("Lattice units in SI units, and the length of a run in seconds", "[si]") {
  const Problem p = parse_scene(scales + rest + cell + "stretch = { force = '30 pN' }\n[accuracy]\nradius = 8\nshear_modulus = 0.02\n", "s.toml");
  const LatticeParameters lattice = to_lattice(p);
  CHECK(lattice.si.length.value() == Approx(5e-7));
  CHECK(lattice.si.force.value() == Approx(15e-6 / 0.02 * 5e-7));
  CHECK(lattice.si.time.value() == Approx(4.8e-6));  // 1.2e-3/(1/6) (5e-7)^2 / 3.75e-10
  CHECK(lattice.cells[0].stretching_force * *lattice.si.force == Approx(30e-12));
  CHECK(lattice.membrane_time * *lattice.si.time == Approx(3.2e-4));
  CHECK(double(lattice.steps) * *lattice.si.time == Approx(32e-3).epsilon(1e-4));
  CHECK(lattice.series_every == std::llround(0.5 * lattice.membrane_time));
  const LatticeParameters plain = to_lattice(parse_scene("[flow]\ncapillary_number = 0.1\n" + cell, "s.toml"));
  CHECK_FALSE(plain.si.length);
  CHECK_FALSE(plain.si.force);
  CHECK_FALSE(plain.si.time);
}

TEST_CASE("run.duration counts eta_0 r / kappa_S also in a flow", "[si]") {
  const Problem p = parse_scene("[flow]\ncapillary_number = 0.1\n[run]\nduration = 50\n" + cell, "s.toml");
  const LatticeParameters lattice = to_lattice(p);
  CHECK(double(lattice.steps) / lattice.steps_per_strain == Approx(50 * 0.1).epsilon(1e-3));  // strain = Ca * duration
}

TEST_CASE("A merged scene with SI values reads back to the same problem", "[si]") {
  const std::string at_rest = scales + rest + cell + "stretch = { force = '30 pN' }\n";
  const std::string in_flow = scales + "shear_rate = 250\n" + cell + "membrane = { bending = '2e-19 J' }\n";
  for (const std::string& text : {at_rest, in_flow}) {
    const Problem p = parse_scene(text, "s.toml");
    const std::string merged = to_toml(p);
    INFO(merged);
    const Problem again = parse_scene(merged, "merged.toml");
    CHECK(to_toml(again) == merged);
    CHECK(again.si.radius == p.si.radius);
    CHECK(again.si.shear_modulus == p.si.shear_modulus);
    CHECK(again.cells[0].membrane.bending == p.cells[0].membrane.bending);
    CHECK(again.cells[0].stretch.force == p.cells[0].stretch.force);
    CHECK(again.flow.capillary_number == p.flow.capillary_number);
    CHECK(to_lattice(again).steps == to_lattice(p).steps);
    CHECK(contains(merged, "[si]"));
  }
  CHECK_FALSE(contains(to_toml(parse_scene("[flow]\ncapillary_number = 0.1\n" + cell, "s.toml")), "[si]"));
}

TEST_CASE("Bad SI values are refused in one sentence with key, value and what is allowed", "[si]") {
  const struct {
    std::string scene;
    std::vector<std::string> parts;
  } bad[] = {
      {"[si]\nradius = '4 um'\n[flow]\ncapillary_number = 0.1\n" + cell + "stretch = { force = '30 pN' }\n", {"s.toml:7", "cells.0.stretch.force = \"30 pN\"", "needs si.shear_modulus"}},
      {"[flow]\ncapillary_number = 0.1\n[box]\nsize = ['24 um', 6, 6]\n" + cell, {"box.size[0] = \"24 um\"", "needs si.radius"}},
      {scales + cell + "stretch = { force = '30 pM' }\n" + rest, {"cells.0.stretch.force = \"30 pM\"", "quantity with its unit such as \"67.7 pN\""}},
      {scales + cell + "stretch = { force = '30 pm' }\n" + rest, {"cells.0.stretch.force = \"30 pm\"", "another dimension", "in N"}},
      {scales + cell + "stretch = { force = '30 MN' }\n" + rest, {"cells.0.stretch.force = \"30 MN\"", "5e+17 κ_S r", "out of range", "<= 10000"}},
      {"[si]\nradius = '4 m'\n" + cell + rest, {"si.radius = \"4 m\" is 4 in SI units", "out of range"}},
      {"[si]\nradius = 3.91\n" + cell + rest, {"si.radius = 3.91 m is out of range", "such as \"3.91 um\""}},
      {"[si]\nradius = '4 um'\n" + cell + "[accuracy]\nradius = '4 um'\n", {"accuracy.radius = \"4 um\"", "must be a number"}},
      {scales + "shear_rate = 250\n[flow]\ncapillary_number = 0.1\n" + cell, {"s.toml:5", "si.shear_rate = 250", "contradicts flow.capillary_number = 0.1"}},
      {scales + "shear_rate = 250\n[accuracy]\nshear_modulus = 0.01\nshear_rate = 1e-5\n" + cell, {"si.shear_rate = 250", "contradicts accuracy.shear_modulus"}},
      {scales + "shear_rate = 250\n" + cell + rest, {"si.shear_rate = 250", "rest", "remove it"}},
      {"[si]\nshear_rate = 250\nradius = 4e-6\n" + cell, {"si.shear_rate = 250", "needs si.viscosity, si.shear_modulus"}},
      {scales + "shear_rate = 1e8\n" + cell, {"si.shear_rate = 1", "capillary number", "<= 1000"}},
      {scales + "[box]\nsize = [4, 4, 4]\n", {"si.", "[[cells]]"}},
      {scales + "[flow]\ncapillary_number = 0.1\n[run]\nduration = '1 s'\nstrain = 4\n" + cell, {"run.duration", "contradicts run.strain = 4"}},
      {scales + "[box]\nwalls = false\n[flow]\nkind = 'rest'\n[run]\nsteps = 100\n[output]\nseries_every = '1 ms'\n" + cell, {"output.series_every = \"1 ms\"", "run.duration"}},
      {"[box]\nsize = [4, 4, 4]\n[run]\nduration = 5\n", {"run.duration = 5", "[[cells]]"}},
  };
  for (const auto& input : bad) {
    const std::string text = message(input.scene);
    INFO(input.scene << "message: " << text);
    CHECK(text != "accepted");
    CHECK_FALSE(contains(text, "\n"));
    for (const std::string& part : input.parts) CHECK(contains(text, part));
  }
  CHECK(contains(message(scales + rest + cell, {"cells.0.stretch.force=5 kg"}), "--set: cells.0.stretch.force = \"5 kg\" has another dimension"));
}
