// The expected error of the viscosity: what was measured comes back, between it is interpolated, beyond it nothing is claimed.
#include <cmath>

#include "io/scene.hpp"
#include "physics/resolution_error.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

namespace {

ResolutionError error_of(const std::string& cells, const std::string& accuracy, const std::string& more = "") {
  const Problem problem = parse_scene("[box]\nsize = [10, 10, 12]\n[flow]\ncapillary_number = 0.08\n[[cells]]\n" + cells + "\n[accuracy]\ncollision = \"trt\"\nrelaxation_time = 2.0\n" + accuracy + "\n" + more,
                                      "s.toml");
  return viscosity_resolution_error(problem, to_lattice(problem));
}

std::string accuracy_of(const MeasuredDeviation& m) {
  return "radius = " + std::to_string(m.radius) + "\ndelta_kernel = " + std::to_string(m.delta_kernel) + (m.counted == CountedBy::hydrodynamic ? "\ncell_size = \"hydrodynamic\"" : "") +
         (m.counted == CountedBy::drag_shell ? "\ncounted_shell = \"drag\"" : "");
}

std::string cells_of(const MeasuredDeviation& m, double phi) {
  return std::string(m.counted == CountedBy::viscosity_shell || m.counted == CountedBy::drag_shell ? "effective_volume_fraction = " : "volume_fraction = ") + std::to_string(phi);
}

}  // namespace

TEST_CASE("resolution error: the table holds what the studies can hold", "[resolution_error]") {
  REQUIRE(measured_deviations().size() > 20);
  for (const auto& m : measured_deviations()) {
    CHECK(m.phi > 0);
    CHECK((m.delta_kernel >= 2 && m.delta_kernel <= 4));
    CHECK((m.radius >= 3 && m.radius <= 16));
    CHECK(m.uncertainty > 0);
    CHECK(std::abs(m.deviation) < 3);
  }
}

TEST_CASE("resolution error: measured settings, and between them", "[resolution_error]") {
  int tried = 0;
  for (const auto& m : measured_deviations()) {
    if (m.counted == CountedBy::mesh && m.phi > 0.3) continue;  // shells overfill the box at small radii
    const ResolutionError found = error_of(cells_of(m, m.phi), accuracy_of(m));
    CAPTURE(m.phi, m.radius, m.delta_kernel, name_of(m.counted), found.reason);
    REQUIRE(found.known());
    // The number of cells is whole, so that phi is a little beside the one that was measured.
    CHECK(std::abs(found.value - m.deviation) < 0.1 * std::abs(m.deviation) + 0.02);
    const ResolutionError half = error_of(cells_of(m, m.phi / 2), accuracy_of(m));
    REQUIRE(half.known());
    if (m.phi < 0.3) CHECK(std::abs(half.value - m.deviation / 2) < 0.1 * std::abs(m.deviation) + 0.02);
    ++tried;
  }
  CHECK(tried > 10);
}

TEST_CASE("resolution error: what wasn't measured isn't claimed", "[resolution_error]") {
  const std::string fraction = "effective_volume_fraction = 0.2", r = "radius = 6\ndelta_kernel = 3";
  CHECK(error_of(fraction, r).known());
  const auto reason = [&](const std::string& cells, const std::string& accuracy, const std::string& more = "") {
    const ResolutionError found = error_of(cells, accuracy, more);
    CHECK_FALSE(found.known());
    CHECK(std::isnan(found.value));
    return found.reason;
  };
  CHECK(reason("effective_volume_fraction = 0.8", r).find("beyond the 0.449") != std::string::npos);
  CHECK(reason(fraction + "\nshape = \"sphere\"", r).find("red cells of one type") != std::string::npos);
  CHECK(reason(fraction, r + "\nshell_thickness = 0.3").find("default accuracy.shell_thickness") != std::string::npos);
  CHECK(reason("count = 1", r).find("suspensions") != std::string::npos);
  CHECK(reason(fraction, "radius = 2.5\ndelta_kernel = 3").find("no study") != std::string::npos);
  const Problem bgk = parse_scene("[box]\nsize = [10, 10, 12]\n[flow]\ncapillary_number = 0.08\n[[cells]]\n" + fraction + "\n[accuracy]\n" + r + "\ncollision = \"bgk\"\nrelaxation_time = 2.0\n", "s.toml");
  CHECK(viscosity_resolution_error(bgk, to_lattice(bgk)).reason.find("TRT") != std::string::npos);
  const Problem fluid = parse_scene("[box]\nsize = [4, 4, 4]\n", "s.toml");
  CHECK(viscosity_resolution_error(fluid, to_lattice(fluid)).reason == "there are no cells");
}

TEST_CASE("resolution error: finer than the finest", "[resolution_error]") {
  const std::string fraction = "effective_volume_fraction = 0.2";
  double finest = 0;
  for (const auto& m : measured_deviations())
    if (m.counted == CountedBy::drag_shell && m.delta_kernel == 3 && m.phi < 0.3) finest = std::max(finest, m.radius);
  const ResolutionError there = error_of(fraction, "counted_shell = \"drag\"\ndelta_kernel = 3\nradius = " + std::to_string(finest)), beyond = error_of(fraction, "counted_shell = \"drag\"\ndelta_kernel = 3\nradius = " + std::to_string(2 * finest));
  // Numbers of cells are whole, so that phi isn't quite the same.
  CHECK(beyond.value == Approx(there.value / 2).margin(0.005));
  CHECK(beyond.uncertainty == Approx(there.uncertainty).epsilon(0.1));
}
