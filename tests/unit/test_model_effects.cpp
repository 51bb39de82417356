// When a scene hears that it can do without a model, and when not.
#include "physics/model_effects.hpp"

#include <algorithm>
#include <functional>

#include "io/scene.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

namespace {

using Change = std::function<void(Problem&)>;

/// Red cells (r = 6) or spheres (r = 5) at a fraction and a Ca between those of the studies, else with defaults; changed.
std::vector<DispensableModel> found(double phi_effective, double ca, const std::string& shape = "red_cell", const Change& change = [](Problem&) {}, double vertex_share = 0.5) {
  Problem problem = parse_scene("[box]\nsize = [10, 10, 10]\n[flow]\ncapillary_number = " + std::to_string(ca) + "\nreynolds_number_max = 0.2\n" +
                                    "[accuracy]\nradius = " + (shape == "sphere" ? "5" : "6") + "\n[run]\nstrain = 1\n" +
                                    "[[cells]]\nshape = '" + shape + "'\neffective_volume_fraction = " + std::to_string(phi_effective) + "\n",
                                "test.toml");
  change(problem);
  return dispensable_models(problem, to_lattice(problem), vertex_share);
}

bool names(const std::vector<DispensableModel>& models, const std::string& left_out_by) {
  return std::any_of(models.begin(), models.end(), [&](const auto& m) { return m.left_out_by == left_out_by; });
}

const std::string contact = "contact.enabled=false", bending = "cells.0.membrane.bending=0", single = "accuracy.membrane_precision=single";

}  // namespace

TEST_CASE("Models that had no effect in the measured pairs around a scene are not needed there", "[model_effects]") {
  const auto dilute = found(0.08, 0.03);
  REQUIRE(names(dilute, contact));
  CHECK(names(dilute, single) == false);  // not measured below phi_eff = 0.1
  CHECK(names(found(0.15, 0.03), single));
  CHECK(names(found(0.4, 0.08), single));
  CHECK(names(found(0.1, 0.1, "sphere"), bending));
  for (const auto& models : {dilute, found(0.15, 0.03), found(0.1, 0.1, "sphere")})
    for (const auto& m : models) {
      INFO(m.model);
      CHECK(m.viscosity_change > 0);
      CHECK(m.viscosity_change <= negligible_viscosity_change);
      CHECK(m.deformation_change <= negligible_deformation_change);
      CHECK(m.measured.find("Ca = ") != std::string::npos);
    }
}

TEST_CASE("What leaving out a model saves is a part of what vertices cost", "[model_effects]") {
  const auto half = found(0.08, 0.03), all = found(0.08, 0.03, "red_cell", [](Problem&) {}, 1);
  REQUIRE(half.size() == all.size());
  for (std::size_t i = 0; i < half.size(); ++i) {
    CHECK(half[i].saved > 0);
    CHECK(half[i].saved < 0.5);
    CHECK(all[i].saved == Approx(2 * half[i].saved));
  }
}

TEST_CASE("Models that matter are needed, and so are those of which nothing was measured around the scene", "[model_effects]") {
  CHECK(!names(found(0.3, 0.03), contact));       // crowded: it matters
  CHECK(!names(found(0.08, 0.005), contact));     // softer flow than measured
  CHECK(!names(found(0.08, 0.2), contact));
  CHECK(!names(found(0.08, 0.03, "sphere"), contact));
  CHECK(!names(found(0.08, 0.05), bending));      // a red cell's tumbling depends on it
  CHECK(!names(found(0.6, 0.05), single));
  CHECK(!names(found(0.1, 0.1, "sphere", [](Problem& p) { p.accuracy.radius = 6; }), bending));  // spheres were measured at r = 5 only
}

TEST_CASE("A scene that differs from those that were measured hears nothing", "[model_effects]") {
  REQUIRE(!found(0.08, 0.03).empty());
  const std::vector<std::pair<const char*, Change>> differences{
      {"Poiseuille flow", [](Problem& p) { p.flow.kind = FlowKind::poiseuille; }},
      {"two types", [](Problem& p) { p.cells.push_back(p.cells[0]), p.cells[0].effective_volume_fraction = p.cells[1].effective_volume_fraction = 0.04; }},
      {"another kernel", [](Problem& p) { p.accuracy.delta_kernel = 4; }},
      {"finer", [](Problem& p) { p.accuracy.radius = 10; }},
      {"coarser", [](Problem& p) { p.accuracy.radius = 4; }},
      {"another relaxation time", [](Problem& p) { p.accuracy.relaxation_time = 0.8; }},
      {"another law", [](Problem& p) { p.cells[0].membrane.law = StrainLawKind::neo_hookean; }},
      {"another area dilation", [](Problem& p) { p.cells[0].membrane.area_dilation = 10; }},
      {"stiffer in bending", [](Problem& p) { p.cells[0].membrane.bending = 0.01; }},
      {"another area force", [](Problem& p) { p.cells[0].membrane.global_area = 10; }},
      {"another volume force", [](Problem& p) { p.cells[0].membrane.volume = 10; }},
      {"smaller cells", [](Problem& p) { p.cells[0].relative_radius = 0.8; }},
      {"pulled", [](Problem& p) { p.cells[0].stretch.force = 0.1; }},
      {"stronger contact", [](Problem& p) { p.contact.strength = 5; }},
      {"contact from farther", [](Problem& p) { p.contact.range = 1.5; }},
  };
  for (const auto& [name, change] : differences) {
    INFO(name);
    CHECK(found(0.08, 0.03, "red_cell", change).empty());
  }
  CHECK(!names(found(0.08, 0.03, "red_cell", [](Problem& p) { p.contact.enabled = false; }), contact));
  CHECK(!names(found(0.1, 0.1, "sphere", [](Problem& p) { p.cells[0].membrane.bending = 0; }), bending));
  CHECK(!names(found(0.3, 0.05, "red_cell", [](Problem& p) { p.accuracy.membrane_precision = Precision::single_precision; }), single));
}
