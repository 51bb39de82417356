// Every way to get a scene wrong: the message is one line that names the key, the value, and what is allowed.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <vector>

#include "core/error.hpp"
#include "io/scene.hpp"
#include "physics/units.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

namespace {

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

struct Bad {
  std::string scene;               ///< TOML text; an override line starts with "--set "
  std::vector<std::string> parts;  ///< what the message must contain
};

const std::string cells = "[box]\nsize = [10, 10, 10]\n[flow]\ncapillary_number = 0.1\n[[cells]]\ncount = 5\n";
const std::string no_ca = "[box]\nsize = [10, 10, 10]\n[[cells]]\ncount = 5\n";
const std::string no_count = "[box]\nsize = [10, 10, 10]\n[flow]\ncapillary_number = 0.1\n[[cells]]\n";
const std::string box = "[box]\nsize = [10, 10, 10]\n";

const std::vector<Bad> bad = {
    // The file as such
    {"", {"s.toml", "empty"}},
    {"# only a comment\n", {"empty"}},
    {"[box\nsize = 1", {"s.toml:1", "TOML"}},
    {"[box]\nsize = [10, 10", {"s.toml:2", "TOML"}},
    {"[box]\nsize = [1,1,1]\nsize = [2,2,2]", {"s.toml:3", "size"}},
    {std::string("\x7f\x45\x4c\x46\x02\x01\x00\x00", 8), {"s.toml", "text"}},
    {"[box]\nsize = [1, 1, 1] \xff\xfe", {"s.toml", "text"}},
    {"hello", {"s.toml:1", "TOML"}},
    {"[run]\nseed = 99999999999999999999999", {"s.toml:2", "TOML"}},
    {"[box] # \u00e9t\u00e9 'fine'\n\u00e9 = 1\n", {"s.toml:2", "'\u00e9'", "quotes"}},
    {box + "[accuracy]\npreset = \u201cdraft\u201d\n", {"s.toml:4", "'\u201c'", "quotes"}},
    // Unknown keys
    {box + "[flow]\ncapilary_number = 0.1\n", {"s.toml:4", "flow.capilary_number", "flow.capillary_number"}},
    {box + "[flwo]\nkind = \"rest\"\n", {"flwo", "nearest known key"}},
    {"size = [1, 2, 3]\n", {"size", "box.size"}},
    {cells + "membrane = { bendign = 0.1 }\n", {"s.toml:7", "cells.0.membrane.bendign", "cells.*.membrane.bending"}},
    {cells + "bending = 0.1\n", {"cells.0.bending", "cells.*.membrane.bending"}},
    {"\"cells.0.count\" = 5\n", {"cells.0.count", "isn't a key"}},
    {"[box]\n\"si\\nze\" = 5\n", {"box.si ze", "isn't a key"}},
    {box + "[viscosity]\n", {"viscosity", "nearest known key"}},
    {"--set flow.capilary_number=0.1\n" + cells, {"--set", "flow.capilary_number", "flow.capillary_number"}},
    // Wrong types
    {"box = 5\n", {"box", "table"}},
    {"[box]\nsize = 10\n", {"box.size = 10", "3 numbers"}},
    {"[box]\nsize = [10, 10]\n", {"box.size", "3 numbers"}},
    {"[box]\nsize = [10, \"a\", 10]\n", {"box.size[1]", "\"a\"", "3 numbers"}},
    {box + "[accuracy]\nradius = \"big\"\n", {"accuracy.radius = \"big\"", "number"}},
    {box + "[accuracy]\nradius = true\n", {"accuracy.radius = true", "number"}},
    {box + "[accuracy]\nradius = { a = 1 }\n", {"accuracy.radius = a table", "number"}},
    {"[box]\nwalls = 1\n", {"box.walls = 1", "true or false"}},
    {box + "[flow]\nkind = 3\n", {"flow.kind = 3", "shear"}},
    {no_count + "count = 5.5\n", {"cells.0.count = 5.5", "whole number"}},
    {no_count + "count = \"many\"\n", {"cells.0.count = \"many\"", "whole number"}},
    {box + "[cells]\ncount = 5\n", {"cells", "[[cells]]"}},
    {"cells = 3\n", {"cells", "[[cells]]"}},
    {"cells = [3]\n", {"cells.0 = 3", "[[cells]]"}},
    {cells + "membrane = 3\n", {"cells.0.membrane = 3", "table"}},
    {box + "[run]\nstrain = 2020-01-01\n", {"run.strain = 2020-01-01", "number"}},
    {"--set accuracy.radius=huge\n" + box, {"--set", "accuracy.radius = \"huge\"", "number"}},
    {"--set accuracy.radius\n" + box, {"--set", "accuracy.radius", "key=value"}},
    {"--set cells.1.count=5\n" + cells, {"--set", "cells.1.count", "1 [[cells]]"}},
    {"--set cells.0.count=5\n" + box, {"--set", "cells.0.count", "[[cells]]"}},
    {"--set cells.x.count=5\n" + cells, {"--set", "cells.x.count", "cells.*.count"}},
    {"--set box.size.0=5\n" + box, {"--set", "box.size.0"}},
    // Values out of range
    {"[box]\nsize = [10, -3, 10]\n", {"box.size[1] = -3", "> 0"}},
    {"[box]\nsize = [10, nan, 10]\n", {"box.size[1] = nan", "> 0"}},
    {"[box]\nsize = [10, inf, 10]\n", {"box.size[1] = inf", "<= 10000"}},
    {"[box]\nsize = [1e300, 10, 10]\n", {"box.size[0] = 1e+300", "<= 10000"}},
    {"[flow]\ncapillary_number = 0\n" + std::string("[[cells]]\ncount = 1\n"), {"flow.capillary_number = 0", "> 0"}},
    {"[flow]\ncapillary_number = -0.1\n" + std::string("[[cells]]\ncount = 1\n"), {"flow.capillary_number = -0.1", "> 0"}},
    {"[flow]\ncapillary_number = nan\n" + std::string("[[cells]]\ncount = 1\n"), {"flow.capillary_number = nan", "> 0"}},
    {no_count + "count = 0\n", {"cells.0.count = 0", ">= 1", "nearest allowed value is 1"}},
    {no_count + "count = -5\n", {"cells.0.count = -5", ">= 1"}},
    {no_count + "count = 9000000000000000000\n", {"cells.0.count = 9000000000000000000", "<= 1"}},
    {no_count + "volume_fraction = 0.85\n", {"cells.0.volume_fraction = 0.85", "<= 0.78"}},
    {no_count + "effective_volume_fraction = 0.95\n", {"cells.0.effective_volume_fraction = 0.95", "<= 0.92"}},
    {no_count + "volume_fraction = -0.1\n", {"cells.0.volume_fraction = -0.1", "> 0"}},
    {box + "[run]\nseed = -1\n", {"run.seed = -1", ">= 0"}},
    {box + "[run]\ndiscard = 1\n", {"run.discard = 1", "< 1"}},
    {box + "[run]\nsteps = 0\n", {"run.steps = 0", ">= 1"}},
    {box + "[output]\nseries_every = 0\n", {"output.series_every = 0", "> 0"}},
    {box + "[accuracy]\ndelta_kernel = 5\n", {"accuracy.delta_kernel = 5", ">= 2 and <= 4", "nearest allowed value is 4"}},
    {cells + "[accuracy]\ncoupling_every = 0\n", {"accuracy.coupling_every = 0", ">= 1 and <= 8", "nearest allowed value is 1"}},
    {cells + "[accuracy]\ncoupling_every = 2.5\n", {"accuracy.coupling_every = 2.5", "whole number"}},
    {cells + "[accuracy]\ncoupling_every = 2\nvertex_update = 'euler'\n", {"accuracy.coupling_every = 2 contradicts accuracy.vertex_update = \"euler\"", "remove one"}},
    {box + "[accuracy]\ncoupling_every = 2\n", {"accuracy.coupling_every = 2 has no effect here", "[[cells]]", "remove"}},
    {box + "[accuracy]\nrelaxation_time = 0.5\n", {"accuracy.relaxation_time = 0.5", "nearest allowed value is 0.505"}},
    {box + "[accuracy]\nrelaxation_time = 9\n", {"accuracy.relaxation_time = 9", "nearest allowed value is 5"}},
    {box + "[accuracy]\nmach_max = 0.5\n", {"accuracy.mach_max = 0.5", "nearest allowed value is 0.3"}},
    {box + "[accuracy]\nradius = 1e9\n", {"accuracy.radius", "<= 100"}},
    // Found by fuzzing, or by thinking like a fuzzer
    {"[box]\n" + repeated("a.", 100'000) + "a = 1\n", {":2:", "500 dots"}},
    {"[" + repeated("a.", 100'000) + "a]\n", {":1:", "500 dots"}},
    {"box.size = [ 7.0, +box\"box\u00b7 \"1.0 ut]\n", {":1:", "isn't valid TOML"}},
    // Characters that toml++ must not see there: where a line of a string goes on, and behind a string that ends in quotes of its own.
    {"[box]\nsize = \"\"\"a \\ \n\u02b9\"\"\"\n", {":3:", "isn't valid TOML", "after a backslash"}},
    {"[box]\nsize = {a = \"\"\"x\"\"\"\", \u02b9 = 1}\n", {":2:", "isn't valid TOML", "inside quotes"}},
    {"[box]\nsize = {a = '''x''''', \u02b9 = 1}\n", {":2:", "isn't valid TOML", "inside quotes"}},
    {"[box]\nsize = \"\"\"\u02b9", {"isn't valid TOML"}},
    {"[box]\nsize = " + repeated("[", 100'000) + "\n", {":2:", "isn't valid TOML"}},
    {box + "[flow]\ncapillary_number = 0.1\n" + repeated("[[cells]]\ncount = 1\n", 100'000), {"cells lists 100000 cell types", "at most 1000"}},
    // Unknown choices
    {box + "[flow]\nkind = \"sheer\"\n", {"flow.kind = \"sheer\"", "shear, poiseuille, rest", "nearest is \"shear\""}},
    {box + "[accuracy]\npreset = \"fast\"\n", {"accuracy.preset = \"fast\"", "draft, standard, reference"}},
    {box + "[accuracy]\ncollision = \"mrt\"\n", {"accuracy.collision = \"mrt\"", "bgk, trt"}},
    {cells + "shape = \"cube\"\n", {"cells.0.shape = \"cube\"", "red_cell, sphere, spheroid, file"}},
    {cells + "membrane = { law = \"hooke\" }\n", {"cells.0.membrane.law = \"hooke\"", "skalak, neo_hookean"}},
    // Contradictions and what is missing
    {cells + "volume_fraction = 0.1\n", {"cells.0.volume_fraction = 0.1", "cells.0.count = 5", "one of both"}},
    {no_count, {"cells.0.count is missing", "volume_fraction"}},
    {"--set flow.capillary_number=0.1\n--set flow.capillary_number_G=0.3\n" + cells, {"--set", "flow.capillary_number_G = 0.3", "flow.capillary_number = 0.1"}},
    {no_ca, {"flow.capillary_number is missing"}},
    {box + "[flow]\ncapillary_number = 0.1\n", {"flow.capillary_number = 0.1", "without cells", "remove"}},
    {cells + "[accuracy]\nshear_rate = 1e-5\nshear_modulus = 0.1\n", {"flow.capillary_number = 0.1", "accuracy.shear_modulus = 0.1", "accuracy.shear_rate = 1e-05"}},
    {box + "[run]\nsteps = 5\nstrain = 3\n", {"run.steps = 5", "run.strain = 3"}},
    {box + "[flow]\nkind = \"rest\"\n", {"run.steps is missing"}},
    {box + "[flow]\nkind = \"rest\"\n[run]\nstrain = 4\n", {"run.strain = 4", "rest", "run.steps"}},
    {box + "[flow]\nkind = \"rest\"\n[run]\nsteps = 4\n[accuracy]\nshear_rate = 1e-5\n", {"accuracy.shear_rate = 1e-05", "rest"}},
    {box + "[flow]\nkind = \"rest\"\n[run]\nsteps = 400\n[output]\nseries_every = 1.5\n", {"output.series_every = 1.5", "whole number"}},
    {box + "[flow]\nkind = \"rest\"\ncapillary_number = 1\n[run]\nsteps = 4\n", {"flow.capillary_number = 1", "rest", "remove"}},
    {"[box]\nwalls = false\n", {"box.walls = false", "shear", "rest"}},
    {"[box]\nwalls = false\n[flow]\nkind = \"poiseuille\"\n", {"box.walls = false", "poiseuille"}},
    {cells + "position = [1, 1, 1]\n", {"cells.0.position = [1, 1, 1]", "count = 1"}},
    {no_count + "count = 1\naxis = [1, 0, 0]\n", {"cells.0.axis", "position"}},
    {no_count + "count = 1\nposition = [5, 5, 5]\naxis = [0, 0, 0]\n", {"cells.0.axis = [0, 0, 0]", "direction"}},
    {no_count + "count = 1\nposition = [5, 5, 50]\n", {"cells.0.position = [5, 5, 50]", "outside", "box.size"}},
    {no_count + "count = 1\nposition = [5, 5, 0.1]\n", {"cells.0.position = [5, 5, 0.1]", "wall", ">= 0.3"}},
    {cells + "aspect_ratio = 0.5\n", {"cells.0.aspect_ratio = 0.5", "spheroid"}},
    {cells + "membrane = { law = \"neo_hookean\", area_dilation = 3 }\n", {"cells.0.membrane.area_dilation = 3", "skalak"}},
    {box + "[accuracy]\ncollision = \"bgk\"\nmagic_parameter = 0.1\n", {"accuracy.magic_parameter = 0.1", "trt"}},
    {box + "[accuracy]\nshear_modulus = 0.1\n", {"accuracy.shear_modulus = 0.1", "[[cells]]"}},
    {cells + "name = \"a/b\"\n", {"cells.0.name = \"a/b\"", "letters"}},
    {cells + "name = \"a\"\n[[cells]]\nname = \"a\"\ncount = 1\n", {"cells.1.name = \"a\"", "unique"}},
    // Files
    {cells + "file = \"nowhere.off\"\n", {"cells.0.file", "nowhere.off", "no such file"}},
    {cells + "shape = \"sphere\"\nfile = \"nowhere.off\"\n", {"cells.0.file", "cells.0.shape = \"sphere\""}},
    {cells + "shape = \"file\"\n", {"cells.0.shape = \"file\"", "cells.0.file"}},
    {cells + "[run]\npacking = \"nowhere.h5\"\n", {"run.packing", "nowhere.h5", "no such file"}},
    {cells + "file = \"open.off\"\n", {"cells.0", "open.off", "open"}},
    {cells + "file = \"fin.off\"\n", {"cells.0", "fin.off"}},
    {cells + "file = \"garbage.off\"\n", {"cells.0", "garbage.off"}},
    // What only the conversion to lattice units sees
    {"[box]\nsize = [10, 1.5, 10]\n[flow]\ncapillary_number = 0.1\n[[cells]]\ncount = 1\n", {"box.size[1] = 1.5", ">= 2"}},
    {"[box]\nsize = [10, 0.1, 10]\n", {"box.size[1] = 0.1", ">= 0.5"}},
    {"[box]\nsize = [9999, 9999, 9999]\n", {"box.size", "nodes"}},
    {no_count + "count = 600\n", {"cells.0.count = 600", "packable", "phi"}},
    {no_count + "volume_fraction = 0.5\n[[cells]]\nshape = \"sphere\"\nvolume_fraction = 0.4\n", {"cells.0.volume_fraction = 0.5", "cells.1.volume_fraction = 0.4", "0.78"}},
    {no_count + "volume_fraction = 1e-5\n", {"cells.0.volume_fraction = 1e-05", "no cell", ">= 0.0015"}},
    {cells + "[accuracy]\nshear_modulus = 5\n", {"accuracy.shear_modulus = 5", "unstable", "must be <= "}},
    {cells + "relative_stiffness = 2\n[accuracy]\nshear_modulus = 4\n", {"accuracy.shear_modulus = 4", "cells.0.relative_stiffness = 2", "must be <= "}},
    {cells + "[accuracy]\nshear_modulus = 0.1\n", {"accuracy.shear_modulus = 0.1", "reynolds_number_max", "must be <="}},
    {box + "[accuracy]\nshear_rate = 0.1\n", {"accuracy.shear_rate = 0.1", "reynolds_number_max", "must be <="}},
    {box + "[flow]\nreynolds_number_max = 100\n[accuracy]\nshear_rate = 0.002\n", {"accuracy.shear_rate = 0.002", "mach_max", "must be <="}},
    {cells + "membrane = { area_dilation = 3000 }\n[accuracy]\nshear_modulus = 0.002\n", {"cells.0.membrane.area_dilation = 3000", "unstable", "must be <= "}},
};

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string message_of(const Bad& input, const std::filesystem::path& folder) {
  std::string text = input.scene;
  std::vector<std::string> overrides;
  while (text.starts_with("--set ")) {
    const std::size_t end = text.find('\n');
    overrides.push_back(text.substr(6, end - 6));
    text.erase(0, end + 1);
  }
  try {
    to_lattice(parse_scene(text, (folder / "s.toml").string(), overrides));
  } catch (const InputError& error) {
    return error.what();
  } catch (const std::exception& error) {
    return std::string("not an InputError: ") + error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("Bad scenes are refused in one sentence with key, value and what is allowed", "[scene]") {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / ("corpuscle_test_scene_bad_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "open.off") << "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n";
  std::ofstream(folder / "fin.off") << "OFF\n5 5 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n3 0 1 4\n";
  std::ofstream(folder / "garbage.off") << "not a mesh at all\n";
  for (const Bad& input : bad) {
    INFO(input.scene);
    const std::string message = message_of(input, folder);
    CHECK(message.find('\n') == std::string::npos);
    CHECK_FALSE(message.starts_with("not an InputError"));
    CHECK(message != "accepted");
    for (const std::string& part : input.parts) {
      INFO("message: " << message);
      CHECK(contains(message, part));
    }
  }
  std::filesystem::remove_all(folder);
}

TEST_CASE("Scene files that can't be read", "[scene]") {
  const auto message = [](const std::string& path) -> std::string {
    try {
      read_scene(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  CHECK(contains(message("no/such/scene.toml"), "no/such/scene.toml: there is no such"));
  CHECK(contains(message(std::filesystem::temp_directory_path().string()), "directory"));
  CHECK(contains(message("/dev/zero"), "4 MiB"));
}
