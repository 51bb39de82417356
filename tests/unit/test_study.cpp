// Study files: knobs and their settings, the reference, repeats, and every way to get one wrong.
#include <cmath>
#include <fstream>

#include "io/study.hpp"
#include "tests/catch.hpp"
#include "tests/complaint.hpp"
#include "tests/scratch.hpp"

using namespace corpuscle;

namespace {

using Names = std::vector<std::string>;

struct Folder {
  ScratchFolder scratch;
  Folder() {
    std::ofstream(scratch / "base.toml") << "[box]\nsize = [4, 4, 4]\n[flow]\ncapillary_number = 0.1\n[[cells]]\ncount = 2\n[accuracy]\nradius = 6\n";
  }
  Study parse(const std::string& text) const { return parse_study(text, (scratch / "study.toml").string()); }
};

const std::string axes = R"(
scene = "base.toml"
[[axis]]
key = "accuracy.radius"
values = [4, 6.0]
[[axis]]
name = "size"
settings = [ { label = "count", set = { "cells.0.count" = 2 } }, { label = "fraction", set = { "cells.0.effective_volume_fraction" = 0.2 } } ]
[[axis]]
key = "run.seed"
values = [1, 2]
[[also]]
"flow.reynolds_number_max" = 0.2
)";
const std::string observed = "[study]\nobservables = [\"relative_viscosity\", \"deformation\"]\n";
const std::string limit = "[study.reference]\nextrapolate = \"accuracy.radius\"\nsame_limit = [\"size\"]\n";

}  // namespace

TEST_CASE("study: knobs, settings and repeats", "[study]") {
  const Folder folder;
  const Study study = folder.parse(axes + observed + limit);
  CHECK(study.observables == Names{"relative_viscosity", "deformation"});
  CHECK(study.knobs == Names{"accuracy.radius", "size", "flow.reynolds_number_max"});
  CHECK(study.base_settings == Names{"6", "count", "0.1"});
  REQUIRE(study.settings.size() == 9);
  CHECK(study.settings[0] == Names{"4", "count", "0.1"});
  CHECK(study.settings[2] == Names{"4", "fraction", "0.1"});
  CHECK(study.settings[8] == Names{"6", "count", "0.2"});
  CHECK(study.sweep.points[2].name == "radius4-size_fraction-seed1");
  const auto repeats = repeats_of(study);
  REQUIRE(repeats.size() == 5);
  CHECK(repeats[0] == std::vector<std::size_t>{0, 1});
  CHECK(repeats[4] == std::vector<std::size_t>{8});
  CHECK(study.reference.extrapolate == "accuracy.radius");
  CHECK(study.reference.same_limit == Names{"size"});
  CHECK(study.wall_layer == 4);
  CHECK_FALSE(study.discard);
}

TEST_CASE("study: what a [[where]] sets is no knob", "[study]") {
  const Folder folder;
  const Study study = folder.parse(axes + "[[where]]\nmatch = { \"accuracy.radius\" = 4 }\nset = { \"run.strain\" = 77 }\n" + observed + limit);
  CHECK(study.knobs == Names{"accuracy.radius", "size", "flow.reynolds_number_max"});
  CHECK(study.settings[0] == Names{"4", "count", "0.1"});
  CHECK(study.sweep.points[0].overrides.back().key == "run.strain");
}

TEST_CASE("study: the other references", "[study]") {
  const Folder folder;
  const Study point = folder.parse(axes + observed + "wall_layer = 0\ndiscard = 2.5\n[study.reference]\npoint = { \"accuracy.radius\" = 4, size = \"fraction\" }\n");
  CHECK(point.reference.point == std::map<std::string, std::string>{{"accuracy.radius", "4"}, {"size", "fraction"}});
  CHECK(point.wall_layer == 0);
  CHECK(point.discard == 2.5);
  const Study values = folder.parse(axes + observed + "[study.reference]\nvalues = { relative_viscosity = 2, deformation = [0.3, 0.01] }\n");
  CHECK(values.reference.values.at("relative_viscosity").error == 0);
  CHECK(values.reference.values.at("deformation").error == 0.01);
}

TEST_CASE("study: observables are taken to the fraction of the study", "[study]") {
  const Folder folder;
  CHECK_FALSE(folder.parse(axes + observed + limit).fraction);
  const auto fraction = folder.parse(axes + observed + "fraction = { phi = 0.2, exponents = { relative_viscosity = 1.5 } }\n" + limit).fraction;
  REQUIRE(fraction);
  CHECK(fraction->phi == 0.2);
  // eta_r - 1 = c phi^1.5 at phi = 0.19 and 0.21 gives the same value at 0.2.
  for (const double phi : {0.19, 0.2, 0.21}) {
    const statistics::Estimate there{.value = 1 + 7 * std::pow(phi, 1.5), .error = 0.01};
    const statistics::Estimate here = at_fraction(there, "relative_viscosity", phi, fraction);
    CHECK(here.value == Approx(1 + 7 * std::pow(0.2, 1.5)).epsilon(1e-12));
    CHECK(here.error == Approx(0.01 * std::pow(0.2 / phi, 1.5)).epsilon(1e-12));
    CHECK(at_fraction(there, "deformation", phi, fraction).value == there.value);
    CHECK(at_fraction(there, "relative_viscosity", phi, {}).value == there.value);
  }
  const StudyFraction of_stress{0.2, {{"normal_stress_difference_1", 2}}};
  CHECK(at_fraction({.value = 0.5, .error = 0.1}, "normal_stress_difference_1", 0.1, of_stress).value == Approx(2).epsilon(1e-12));
}

TEST_CASE("study: what is wrong is said in a sentence", "[study]") {
  const Folder folder;
  const std::string head = axes + observed;
  struct Bad {
    std::string text;
    std::vector<const char*> words;
  };
  const std::vector<Bad> wrong{
      {axes, {"[study] is missing", "docs/tradeoff.md"}},
      {axes + "[study]\n" + limit, {"observables = [...]"}},
      {axes + "[study]\nobservables = [\"relativ_viscosity\"]\n" + limit, {"relativ_viscosity", "the nearest is relative_viscosity"}},
      {axes + "[study]\nobservables = []\n" + limit, {"at least one name"}},
      {axes + "[study]\nobservables = [\"deformation\", \"deformation\"]\n" + limit, {"names deformation twice"}},
      {axes + "[study]\nobservables = [3]\n" + limit, {"must be a list of names"}},
      {head + "walllayer = 0\n" + limit, {"walllayer isn't a key of [study]", "the nearest is wall_layer"}},
      {head + "fraction = 0.2\n" + limit, {"fraction = 0.2 must be a table such as"}},
      {head + "fraction = { phi = 0.2 }\n" + limit, {"[study.fraction] must be a table such as"}},
      {head + "fraction = { phi = 1.2, exponents = {} }\n" + limit, {"phi = 1.2 must be > 0 and < 1"}},
      {head + "fraction = { phi = 0.2, exponents = { inclination = 1 } }\n" + limit, {"inclination is none of the observables: relative_viscosity, deformation"}},
      {head + "fraction = { phi = 0.2, exponents = { deformation = 11 } }\n" + limit, {"deformation = 11 must be a number between -10 and 10"}},
      {head + "fraction = { phi = 0.2, exponents = {}, exponent = 1 }\n" + limit, {"exponent isn't a key of [study.fraction]"}},
      {head + "wall_layer = -1\n" + limit, {"wall_layer = -1 must be a number >= 0"}},
      {head, {"[study.reference] is missing", "extrapolate"}},
      {head + "[study.reference]\n", {"exactly one of"}},
      {head + "[study.reference]\nextrapolate = \"accuracy.radius\"\nvalues = {}\n", {"exactly one of"}},
      {head + "[study.reference]\nextrapolate = \"accuracy.delta_kernel\"\n", {"accuracy.delta_kernel is no knob", "its knobs are accuracy.radius, size"}},
      {head + "[study.reference]\nextrapolate = \"size\"\n", {"count is no positive number"}},
      {head + "[study.reference]\nextrapolate = \"accuracy.radius\"\nsame_limit = [\"accuracy.radius\"]\n", {"is the knob of the extrapolation"}},
      {head + "[study.reference]\nvalues = { deformation = 1, relative_viscosity = 2 }\nsame_limit = [\"size\"]\n", {"same_limit has a meaning with extrapolate only"}},
      {head + "[study.reference]\nvalues = { deformation = 1 }\n", {"values lacks the observable relative_viscosity"}},
      {head + "[study.reference]\nvalues = { deformation = 0, relative_viscosity = 2 }\n", {"deformation = 0 must be"}},
      {head + "[study.reference]\npoint = { \"accuracy.radius\" = 5 }\n", {"no point of the study has these settings"}},
      {"scene = \"base.toml\"\n[[axis]]\nkey = \"run.seed\"\nvalues = [1, 2]\n" + observed + limit, {"nothing varies but the seed"}},
      {"scene = \"nowhere.toml\"\n[[axis]]\nkey = \"accuracy.radius\"\nvalues = [4]\n" + observed + limit, {"nowhere.toml", "no such scene file"}},
  };
  for (const auto& [text, words] : wrong) {
    INFO(text);
    CHECK(complaint_lacks([&, &text = text] { (void)folder.parse(text); }, words) == "");
  }
}
