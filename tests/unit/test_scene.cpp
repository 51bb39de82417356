// Reading scenes: defaults, presets, overrides, round trip, the reference of keys. Bad input is in test_scene_bad.cpp.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/error.hpp"
#include "io/scene.hpp"
#include "io/scene_keys.hpp"
#include "physics/units.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

namespace {

const std::filesystem::path source_root = std::filesystem::absolute(std::filesystem::path(__FILE__)).parent_path().parent_path().parent_path();

/// Every key of two scenes, also those that to_toml leaves out.
void check_same(const Problem& a, const Problem& b) {
  REQUIRE(a.cells.size() == b.cells.size());
  Problem x = a, y = b;
  CellSpec none;
  for (const scene::Key& key : scene::keys()) {
    INFO(key.name);
    if (!key.name.starts_with("cells.")) CHECK(scene::value_text(key, key.field(x, none)) == scene::value_text(key, key.field(y, none)));
    else for (std::size_t i = 0; i < x.cells.size(); ++i) CHECK(scene::value_text(key, key.field(x, x.cells[i])) == scene::value_text(key, key.field(y, y.cells[i])));
  }
}

void check_round_trip(const Problem& problem) {
  const std::string text = to_toml(problem);
  INFO(text);
  const Problem again = parse_scene(text, "merged.toml");
  check_same(problem, again);
  CHECK(to_toml(again) == text);
}

const char* const simple = R"(
[box]
size = [10, 10, 12]
[flow]
capillary_number = 0.1
[[cells]]
count = 10
)";

}  // namespace

TEST_CASE("A short scene gets the documented defaults", "[scene]") {
  const Problem problem = parse_scene(simple, "simple.toml");
  CHECK(problem.box.size == std::array<double, 3>{10, 10, 12});
  CHECK(problem.flow.kind == FlowKind::shear);
  CHECK(problem.flow.capillary_number == 0.1);
  REQUIRE(problem.cells.size() == 1);
  CHECK(problem.cells[0].name == "red_cell");
  CHECK(problem.cells[0].count == 10);
  CHECK(problem.cells[0].membrane.bending == Approx(1.0 / 405));
  CHECK(problem.accuracy.preset == "standard");
  CHECK(problem.accuracy.radius == 8);
  CHECK(problem.run.seed == 1);
}

TEST_CASE("The defaults of problem.hpp are the standard preset", "[scene]") {
  AccuracySpec accuracy;
  scene::apply_preset(accuracy, "standard");
  const AccuracySpec plain;
  CHECK(accuracy.radius == plain.radius);
  CHECK(accuracy.delta_kernel == plain.delta_kernel);
  CHECK(accuracy.collision == plain.collision);
  CHECK(accuracy.precision == plain.precision);
}

TEST_CASE("Presets set knobs, and a knob given beside a preset wins wherever it stands", "[scene]") {
  const Problem reference = parse_scene("[accuracy]\nradius = 10\npreset = \"reference\"", "s.toml");
  CHECK(reference.accuracy.radius == 10);
  CHECK(reference.accuracy.delta_kernel == 2);
  CHECK(reference.accuracy.collision == CollisionKind::trt);
  CHECK(parse_scene("[accuracy]\ndelta_kernel = 4\nprecision = \"double\"\npreset = \"reference\"", "s.toml").accuracy.delta_kernel == 4);
  const Problem draft = parse_scene("[accuracy]\npreset = \"draft\"", "s.toml");
  CHECK(draft.accuracy.radius == 4);
  CHECK(draft.accuracy.precision == Precision::single_precision);
  // On the command line the preset takes the knobs of the file with it, else it would change nothing in a merged scene.
  const Problem coarse = parse_scene("[accuracy]\npreset = \"reference\"\ncollision = \"bgk\"\ndelta_kernel = 3\nrelaxation_time = 0.8", "s.toml");
  const Problem overridden = parse_scene(to_toml(coarse), "s.toml", {"accuracy.preset=draft", "accuracy.precision=double"});
  CHECK(overridden.accuracy.radius == 4);
  CHECK(overridden.accuracy.delta_kernel == 2);
  CHECK(overridden.accuracy.collision == CollisionKind::trt);
  CHECK(overridden.accuracy.relaxation_time == 2);
  CHECK(overridden.accuracy.precision == Precision::double_precision);
}

TEST_CASE("A scene with TRT and no relaxation time gets the one of fewest steps, and the merged scene has it", "[scene]") {
  const auto tau = [](const std::string& accuracy, const std::vector<std::string>& overrides = {}) { return parse_scene(std::string(simple) + accuracy, "s.toml", overrides).accuracy.relaxation_time; };
  CHECK(tau("") == 2);
  CHECK(tau("[accuracy]\ncollision = \"trt\"\n") == 2);
  CHECK(tau("[accuracy]\nrelaxation_time = 1.3\n") == 1.3);
  CHECK(tau("[accuracy]\ncollision = \"bgk\"\n") == 1);
  CHECK(tau("", {"flow.capillary_number=0.0005"}) == 1);
  const Problem stiff = parse_scene(simple, "s.toml", {"flow.capillary_number=0.0005"});
  CHECK(parse_scene(to_toml(stiff), "merged.toml", {"run.strain=1"}).accuracy.relaxation_time == 1);
}

TEST_CASE("Overrides change, add and replace alternatives", "[scene]") {
  const auto with = [](std::vector<std::string> overrides) { return parse_scene(simple, "simple.toml", overrides); };
  CHECK(with({"flow.capillary_number=0.05"}).flow.capillary_number == 0.05);
  CHECK(with({"box.size=[8, 9, 10]"}).box.size == std::array<double, 3>{8, 9, 10});
  CHECK(with({"cells.0.shape=sphere"}).cells[0].shape == ShapeKind::sphere);
  CHECK(with({"cells.0.shape=\"sphere\""}).cells[0].name == "sphere");
  CHECK(with({" run.strain = 3 "}).run.strain == 3);
  CHECK(with({"cells.0.membrane.law=neo_hookean"}).cells[0].membrane.law == StrainLawKind::neo_hookean);
  CHECK(with({"cells.0.membrane={bending = 0}"}).cells[0].membrane.bending == 0);
  CHECK(with({"cells.0.count=1e3"}).cells[0].count == 1000);
  CHECK(with({"output.fluid=true"}).output.fluid);

  const Problem fraction = with({"cells.0.volume_fraction=0.2"});
  CHECK_FALSE(fraction.cells[0].count);
  CHECK(fraction.cells[0].volume_fraction == 0.2);
  const Problem g = with({"flow.capillary_number_G=0.3"});
  CHECK_FALSE(g.flow.capillary_number);
  CHECK(with({"run.strain=3", "run.strain=4"}).run.strain == 4);  // the last one wins
  const Problem steps = parse_scene(to_toml(with({"run.strain=5"})), "s.toml", {"run.steps=100"});
  CHECK(steps.run.steps == 100);
}

TEST_CASE("Cell types get unique names", "[scene]") {
  const std::string two = std::string(simple) + "[[cells]]\ncount = 1\n[[cells]]\nshape = \"sphere\"\nname = \"red_cell\"\ncount = 2\n";
  const Problem problem = parse_scene(two, "s.toml");
  CHECK(problem.cells[0].name == "red_cell_2");
  CHECK(problem.cells[1].name == "red_cell_3");
  CHECK(problem.cells[2].name == "red_cell");
  check_round_trip(problem);
}

TEST_CASE("At rest the cadences are steps", "[scene]") {
  const Problem problem = parse_scene("[box]\nwalls = false\n[flow]\nkind = \"rest\"\n[run]\nsteps = 1000\n[[cells]]\ncount = 1\n", "s.toml");
  CHECK(problem.output.series_every == 5);
  CHECK(problem.output.snapshot_every == 100);
  check_round_trip(problem);
}

TEST_CASE("A merged scene names every key that applies to it", "[scene]") {
  const Problem problem = parse_scene(std::string(simple) + "[guards]\nvolume_drift = 0.01\n", "s.toml");
  const std::string text = to_toml(problem);
  CHECK(text.find("volume_drift = 0.01\n") != std::string::npos);
  for (const auto& key : scene::keys()) {
    std::string reason;
    if (key.section() == "si" || key.section() == "cells.*.stretch" || !scene::applies(key, problem, problem.cells.at(0), reason)) continue;
    const std::string leaf(key.leaf());
    INFO(key.name);
    CHECK((text.find("\n" + leaf + " = ") != std::string::npos || text.find("\n# " + leaf + " not set") != std::string::npos));
  }
}

TEST_CASE("A merged scene reads back to the same problem", "[scene]") {
  check_round_trip(parse_scene("[box]\nsize = [4, 4, 4]", "s.toml"));
  check_round_trip(parse_scene(simple, "simple.toml"));
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / ("corpuscle_test_scene_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "my \"mesh\".off") << "OFF\n";
  const std::string full = R"(
[box]
size = [11.3, 10, 30.123456789012345]
[flow]
capillary_number_G = 1e-3
reynolds_number_max = 0.3333333333333333
[[cells]]
name = "one"
file = 'my "mesh".off'
count = 1
position = [1.5, 2.5, 3.25]
axis = [1, 0, 1e-7]
relative_radius = 0.7
[cells.membrane]
area_dilation = 0.1
global_area = 12.5
volume = 0
[[cells]]
shape = "spheroid"
aspect_ratio = 1.7
effective_volume_fraction = 0.123
relative_stiffness = 3
membrane = { law = "neo_hookean", bending = 0, bending_constant = 1.7320508075688772 }
[contact]
enabled = false
range = 1.5
[accuracy]
preset = "reference"
subdivision = 11
magic_parameter = 0.25
relaxation_time = 0.9
membrane_precision = "single"
shear_modulus = 0.01
[run]
steps = 123456789012
seed = 9007199254740993
discard = 0.5
[output]
series_every = 0.01
snapshot_every = 0
trajectories = false
fluid = true
)";
  const Problem problem = parse_scene(full, (folder / "full.toml").string());
  CHECK(problem.cells[0].shape == ShapeKind::file);
  CHECK(std::filesystem::path(problem.cells[0].file) == folder / "my \"mesh\".off");
  CHECK(problem.run.seed == 9007199254740993u);
  check_round_trip(problem);
  std::filesystem::remove_all(folder);
}

TEST_CASE("The ready scenes can be read and converted", "[scene]") {
  int scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_root / "scenes")) {
    if (entry.path().extension() != ".toml") continue;
    INFO(entry.path());
    const Problem problem = read_scene(entry.path().string());
    check_round_trip(problem);
    CHECK(to_lattice(problem).steps > 0);
    ++scenes;
  }
  CHECK(scenes >= 7);
}

TEST_CASE("docs/scene.md contains the reference made from the table of keys", "[scene]") {
  std::ifstream file(source_root / "docs" / "scene.md");
  std::stringstream docs;
  docs << file.rdbuf();
  std::istringstream lines(scene_key_reference());
  for (std::string line; std::getline(lines, line);) {
    INFO("docs/scene.md lacks this line of scene_key_reference(): " << line);
    CHECK(docs.str().find(line + "\n") != std::string::npos);
  }
  for (const std::string& name : scene_key_names()) CHECK(docs.str().find("`" + name.substr(name.rfind('.') + 1) + "`") != std::string::npos);
}

TEST_CASE("The nearest key", "[scene]") {
  CHECK(scene::edit_distance("", "abc") == 3);
  CHECK(scene::edit_distance("kitten", "sitting") == 3);
  CHECK(scene::edit_distance("szie", "size") == 1);
  CHECK(scene::nearest_key("box.szie") == "box.size");
  CHECK(scene::nearest_key("flow.capilary_number") == "flow.capillary_number");
  CHECK(scene::nearest_key("flow.radius") == "accuracy.radius");
  CHECK(scene::nearest_key("acuracy.radius") == "accuracy.radius");
  CHECK(scene::nearest_key("size") == "box.size");
  CHECK(scene::nearest_key("cells.*.bending") == "cells.*.membrane.bending");
  CHECK(scene::nearest_key("") != "");
}

TEST_CASE("What differs between two scenes is told by key", "[scene]") {
  const Problem a = parse_scene(simple, "simple.toml");
  CHECK(scene_differences(a, a, "there", "here").empty());
  const Problem b = parse_scene(simple, "simple.toml", {"run.strain=3", "cells.0.volume_fraction=0.2", "accuracy.vertex_update=chebyshev"});
  const auto differences = scene_differences(a, b, "there", "here");
  CHECK(differences == std::vector<std::string>{"cells.0.count = 10 there, (not set) here", "cells.0.volume_fraction = (not set) there, 0.2 here",
                                                "accuracy.vertex_update = \"averaged\" there, \"chebyshev\" here", "run.strain = 10 there, 3 here"});
  Problem none = a;
  none.cells.clear();
  CHECK(scene_differences(a, none, "there", "here").front() == "1 [[cells]] there, 0 here");
}
