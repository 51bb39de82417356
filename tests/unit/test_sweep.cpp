// Sweep files: the matrix, names of points, [[also]], [[where]], and every way to get one wrong.
#include <fmt/format.h>

#include <chrono>
#include <fstream>
#include <vector>

#include "io/sweep.hpp"
#include "tests/catch.hpp"
#include "tests/complaint.hpp"
#include "tests/scratch.hpp"

using namespace corpuscle;

namespace {

std::vector<std::string> names(const Sweep& sweep) {
  std::vector<std::string> list;
  for (const auto& point : sweep.points) list.push_back(point.name);
  return list;
}

Sweep parse(const std::string& text) { return parse_sweep(text, "folder/sweep.toml"); }

const std::string paper = R"(
scene = "base.toml"
[[axis]]
key = "cells.0.effective_volume_fraction"
values = [0.12, 0.24]
[[axis]]
key = "flow.capillary_number"
values = [0.081, 2.8e-3]
)";

using Names = std::vector<std::string>;

}  // namespace

TEST_CASE("sweep: the matrix of the axes, the last one running fastest, and its names", "[sweep]") {
  const Sweep sweep = parse(paper);
  CHECK(sweep.scene == "folder/base.toml");
  CHECK(names(sweep) == Names{"phi0.12-Ca0.081", "phi0.12-Ca0.0028", "phi0.24-Ca0.081", "phi0.24-Ca0.0028"});
  CHECK(sweep.points[1].texts() == Names{"cells.0.effective_volume_fraction=0.12", "flow.capillary_number=0.0028"});
}

TEST_CASE("sweep: [[also]] adds points, quoted, dotted and nested keys alike", "[sweep]") {
  const Sweep sweep = parse(paper + R"(
[[also]]
"flow.capillary_number" = 2.8e-4
"cells.0.effective_volume_fraction" = 0.45
[[also]]
flow.capillary_number = 8.4e-5
cells.0.effective_volume_fraction = 0.45
run = { strain = 3 }
[[also]]
flow.capillary_number = 0.5
)");
  REQUIRE(sweep.points.size() == 7);
  CHECK(sweep.points[4].name == "phi0.45-Ca0.00028");
  CHECK(sweep.points[5].name == "phi0.45-Ca8.4e-05-strain3");
  CHECK(sweep.points[5].texts() == Names{"cells.0.effective_volume_fraction=0.45", "flow.capillary_number=8.4e-05", "run.strain=3"});
  CHECK(sweep.points[6].name == "Ca0.5");  // the volume fraction is that of the scene
}

TEST_CASE("sweep: [[where]] changes the points that it matches, a later one wins, a point's own values win over it", "[sweep]") {
  const Sweep sweep = parse(paper + R"(
[[also]]
flow.capillary_number = 0.0028
run.strain = 1
[[where]]
match = { "flow.capillary_number" = 0.0028 }
set = { "run.strain" = 20, "accuracy.vertex_update" = "chebyshev" }
[[where]]
match = { "flow.capillary_number" = [0.0028, 0.5], "cells.0.effective_volume_fraction" = 0.24 }
set = { "run.strain" = 40, "box.size" = [8, 8, 10] }
)");
  REQUIRE(sweep.points.size() == 5);
  CHECK(sweep.points[0].texts().size() == 2);
  CHECK(sweep.points[1].texts() == Names{"cells.0.effective_volume_fraction=0.12", "flow.capillary_number=0.0028", "accuracy.vertex_update=\"chebyshev\"", "run.strain=20"});
  CHECK(sweep.points[3].texts() == Names{"cells.0.effective_volume_fraction=0.24", "flow.capillary_number=0.0028", "accuracy.vertex_update=\"chebyshev\"", "run.strain=40",
                                        "box.size=[8, 8, 10]"});
  CHECK(sweep.points[4].texts() == Names{"flow.capillary_number=0.0028", "run.strain=1", "accuracy.vertex_update=\"chebyshev\""});
  CHECK(names(sweep)[3] == "phi0.24-Ca0.0028");  // what follows from the others isn't in the name
}

TEST_CASE("sweep: names have what varies, are fit for files, and tell keys apart", "[sweep]") {
  const auto with = [](const std::string& axes) { return names(parse("scene = \"s.toml\"\n" + axes)); };
  CHECK(with("[[axis]]\nkey = \"run.seed\"\nvalues = [1, 2]\n[[axis]]\nkey = \"run.strain\"\nvalues = [5]") == Names{"seed1", "seed2"});
  CHECK(with("[[axis]]\nkey = \"run.strain\"\nvalues = [5]") == Names{"base"});
  CHECK(with("[[axis]]\nkey = \"accuracy.vertex_update\"\nvalues = [\"euler\", \"averaged\"]") == Names{"vertex_update_euler", "vertex_update_averaged"});
  CHECK(with("[[axis]]\nkey = \"box.size\"\nvalues = [[8, 8, 8], [8.5, 8, 10]]") == Names{"size8x8x8", "size8.5x8x10"});
  CHECK(with("[[axis]]\nkey = \"output.fluid\"\nvalues = [true, false]") == Names{"fluid_true", "fluid_false"});
  CHECK(with("[[axis]]\nkey = \"run.packing\"\nvalues = [\"../a b/p.h5\", \"q.h5\"]") == Names{"packing_.._a_b_p.h5", "packing_q.h5"});
  CHECK(with("[[axis]]\nkey = \"cells.1.volume_fraction\"\nvalues = [0.1]\n[[axis]]\nkey = \"cells.2.volume_fraction\"\nvalues = [0.1, 0.2]") ==
        Names{"cells2.phi0.1", "cells2.phi0.2"});
  // Two keys with one symbol, and two with one name: the whole key tells.
  CHECK(with("[[also]]\ncells.0.volume_fraction = 0.1\n[[also]]\ncells.0.effective_volume_fraction = 0.1") == Names{"volume_fraction0.1", "effective_volume_fraction0.1"});
  CHECK(with("[[also]]\naccuracy.shear_modulus = 0.1\n[[also]]\nsi.shear_modulus = \"5 uN/m\"") == Names{"accuracy.shear_modulus0.1", "si.shear_modulus_5_uN_m"});
}

TEST_CASE("sweep: what is wrong is told with its line", "[sweep]") {
  struct Bad {
    std::string text;
    std::vector<const char*> words;
  };
  const std::string scene = "scene = \"s.toml\"\n", axis = "[[axis]]\nkey = \"run.seed\"\n";
  const std::vector<Bad> bad{
      {"", {"sweep.toml: ", "`scene` is missing"}},
      {"scene = 3\n", {"sweep.toml:1: ", "scene = 3"}},
      {"[[axis", {"sweep.toml:1: ", "TOML"}},
      {std::string("scene\0", 6), {"isn't a text file", "a sweep starts with"}},
      {scene, {"has no points", "[[axis]]"}},
      {scene + "[[axes]]\nkey = 1", {"sweep.toml:2: ", "axes", "nearest is axis"}},
      {scene + "axis = 3", {"sweep.toml:2: ", "[[axis]] with two brackets"}},
      {scene + "[axis]\nkey = \"run.seed\"", {"[[axis]] with two brackets"}},
      {scene + "axis = [3]", {"axis = 3", "must be a table"}},
      {scene + "[[axis]]\nvalues = [1]", {"sweep.toml:2: ", "needs key"}},
      {scene + "[[axis]]\nkey = 3\nvalues = [1]", {"sweep.toml:3: ", "needs key"}},
      {scene + "[[axis]]\nkey = \"flow.capilary_number\"\nvalues = [1]", {"sweep.toml:3: ", "flow.capilary_number", "nearest known key is flow.capillary_number"}},
      {scene + "[[axis]]\nkey = \"cells.0.membrane\"\nvalues = [1]", {"sweep.toml:3: ", "is a table of a scene"}},
      {scene + axis, {"sweep.toml:2: ", "run.seed", "needs values"}},
      {scene + axis + "values = []", {"needs values"}},
      {scene + axis + "values = 3", {"needs values"}},
      {scene + axis + "value = [3]", {"sweep.toml:4: ", "value isn't a key of [[axis]]", "nearest is values"}},
      {scene + axis + "values = [1, 2, 1.0]", {"sweep.toml:4: ", "run.seed", "the value 1 twice"}},
      {scene + axis + "values = [nan]", {"run.seed", "must be a number"}},
      {scene + axis + "values = [1979-05-27]", {"run.seed", "must be a number"}},
      {scene + axis + "values = [{a = 1}]", {"run.seed", "must be a number"}},
      {scene + axis + "values = [[[1]]]", {"list of lists"}},
      {scene + axis + "values = [1]\n" + axis + "values = [2]", {"sweep.toml:6: ", "run.seed has an axis already"}},
      {scene + "[[also]]\nflow.kin = 3", {"sweep.toml:3: ", "flow.kin", "flow.kind"}},
      {scene + "[[also]]\nrun.seed = 3\n\"run.seed\" = 4", {"run.seed is given twice"}},
      {paper + "[[also]]\nflow.capillary_number = 0.081\ncells.0.effective_volume_fraction = 0.240", {"phi0.24-Ca0.081 is there twice"}},
      {scene + "[[axis]]\nkey = \"run.packing\"\nvalues = [\"a b\", \"a_b\"]", {"two points would have the directory packing_a_b"}},
      {scene + "[[axis]]\nkey = \"run.packing\"\nvalues = [\"a\", \"" + std::string(300, 'b') + "\"]", {"directory name of 308 characters"}},
      {paper + "[[where]]\nset = { \"run.strain\" = 1 }", {"sweep.toml:9: ", "needs match"}},
      {paper + "[[where]]\nmatch = {}\nset = { \"run.strain\" = 1 }", {"needs match"}},
      {paper + "[[where]]\nmatch = { \"flow.capillary_number\" = 0.081 }", {"sweep.toml:9: ", "needs set"}},
      {paper + "[[where]]\nmatch = { \"flow.capillary_number\" = 0.08 }\nset = { \"run.strain\" = 1 }", {"sweep.toml:9: ", "matches no point"}},
      {paper + "[[where]]\nmatch = { \"run.seed\" = 1 }\nset = { \"run.strain\" = 1 }", {"matches no point"}},
      {paper + "[[where]]\nmatch = { \"flow.capillary_number\" = 0.081 }\nset = { \"cells.0.effective_volume_fraction\" = 1 }", {"can't set cells.0.effective_volume_fraction"}},
      {paper + "[[where]]\nmatches = { \"flow.capillary_number\" = 0.081 }", {"matches isn't a key of [[where]]", "nearest is match"}},
  };
  for (const Bad& b : bad) {
    INFO(b.text);
    CHECK(complaint_lacks([&] { parse(b.text); }, b.words) == "");
  }
  for (const char* type : {"00", "*"}) {
    const std::string key = fmt::format("cells.{}.count", type);
    CHECK(complaint_lacks([&] { parse(scene + "[[also]]\n\"" + key + "\" = 1"); }, {"sweep.toml:3: ", key.c_str(), "without leading zeros"}) == "");
  }
  std::string many = scene;
  for (const char* key : {"run.seed", "run.strain", "run.discard"}) {
    many += std::string("[[axis]]\nkey = \"") + key + "\"\nvalues = [";
    for (int i = 0; i < 30; ++i) many += std::to_string(i) + ", ";
    many += "]\n";
  }
  CHECK(complaint_lacks([&] { parse(many); }, {"more than 10000 points"}) == "");
}

TEST_CASE("sweep: an axis of settings changes several keys together", "[sweep]") {
  const std::string size = R"(
[[axis]]
name = "size"
settings = [ { label = "base", set = {} }, { label = "small", set = { "accuracy.radius" = 4, box.size = [4, 4, 4] } } ]
)";
  const Sweep sweep = parse(paper + size);
  REQUIRE(sweep.points.size() == 8);
  CHECK(names(sweep)[0] == "phi0.12-Ca0.081-size_base");
  CHECK(names(sweep)[1] == "phi0.12-Ca0.081-size_small");
  CHECK(sweep.points[0].texts() == Names{"cells.0.effective_volume_fraction=0.12", "flow.capillary_number=0.081"});
  CHECK(sweep.points[1].texts().size() == 4);
  REQUIRE(sweep.axes.size() == 3);
  CHECK(sweep.axes[1].is_key);
  CHECK_FALSE(sweep.axes[2].is_key);
  CHECK(sweep.axes[2].settings[1].label == "small");

  const std::string begin = "scene = \"s.toml\"\n[[axis]]\n";
  const std::vector<std::pair<std::string, const char*>> bad{
      {"name = \"size\"", "needs settings"},
      {"settings = [ { label = \"a\", set = {} } ]", "needs name"},
      {"name = \"si/ze\"\nsettings = [ { label = \"a\", set = {} } ]", "a word of letters"},
      {"name = \"size\"\nkey = \"run.seed\"\nsettings = []", "not both"},
      {"name = \"run.seed\"\nsettings = [ { label = \"a\", set = {} } ]", "a word of letters"},
      {"name = \"size\"\nsettings = [ 3 ]", "must be a table"},
      {"name = \"size\"\nsettings = [ { set = {} } ]", "needs label"},
      {"name = \"size\"\nsettings = [ { label = \"a\" } ]", "needs set"},
      {"name = \"size\"\nsettings = [ { label = \"a\", set = {} }, { label = \"a\", set = { \"run.seed\" = 2 } } ]", "the label a twice"},
      {"name = \"size\"\nsettings = [ { label = \"a\", set = { \"run.sed\" = 2 } } ]", "run.seed"},
      {"name = \"size\"\nsettings = [ { label = \"a\", set = {} } ]\n[[axis]]\nname = \"size\"\nsettings = [ { label = \"b\", set = {} } ]", "another axis"},
      {"key = \"run.seed\"\nvalues = [1]\n[[axis]]\nname = \"size\"\nsettings = [ { label = \"b\", set = { \"run.seed\" = 3 } } ]", "run.seed has an axis already"},
      {"name = \"size\"\nsettings = [ { label = \"b\", set = { \"run.seed\" = 3 } } ]\n[[axis]]\nkey = \"run.seed\"\nvalues = [1]", "run.seed has an axis already"},
  };
  for (const auto& [text, words] : bad) {
    INFO(text);
    CHECK(complaint_lacks([&, &text = text] { parse(begin + text); }, {words}) == "");
  }
  // The table of a study is none of a sweep.
  CHECK(complaint_lacks([] { parse(paper + "[study]\n"); }, {"study isn't a key of a sweep"}) == "");
}

TEST_CASE("sweep: values are told apart exactly, as far as numbers reach", "[sweep]") {
  const auto with = [](const std::string& values) { return names(parse("scene = \"s.toml\"\n[[axis]]\nkey = \"run.seed\"\nvalues = [" + values + "]")); };
  CHECK(with("1e-310, 4.9e-324, 0") == Names{"seed1e-310", "seed5e-324", "seed0"});  // numbers that strtod calls out of range
  CHECK(with("9007199254740992, 9007199254740993") == Names{"seed9007199254740992", "seed9007199254740993"});  // one double, two seeds
  CHECK(complaint_lacks([&] { with("0, -0.0"); }, {"the value 0 twice"}) == "");
  const std::string list = "scene = \"s.toml\"\n[[axis]]\nkey = \"box.size\"\nvalues = [[8, 8, 8], [8, 8.0, 8]]";
  CHECK(complaint_lacks([&] { parse(list); }, {"the value [8, 8, 8] twice"}) == "");
}

TEST_CASE("sweep: what would take hours or gigabytes is refused, or read, within seconds", "[sweep]") {
  const std::string scene = "scene = \"s.toml\"\n";
  const auto repeated = [](int count, const auto& text) {
    std::string all;
    for (int i = 0; i < count; ++i) all += text(i);
    return all;
  };
  const auto number = [](int i) { return std::to_string(i) + ",\n"; };
  const auto one_axis = [](int i) { return fmt::format("[[axis]]\nkey = \"cells.{}.count\"\nvalues = [1]\n", i); };
  const auto one_key = [](int i) { return fmt::format("cells.{}.count = 1\n", i); };
  const auto begin = std::chrono::steady_clock::now();
  CHECK(complaint_lacks([&] { parse(scene + "[[axis]]\nkey = \"run.seed\"\nvalues = [" + repeated(100'000, number) + "]"); }, {"run.seed has 100000 values", "at most 10000"}) == "");
  CHECK(complaint_lacks([&] { parse(scene + repeated(33, one_axis)); }, {"sweep.toml:98: ", "more than 32 axes"}) == "");
  CHECK(complaint_lacks([&] { parse(scene + "[[also]]\n" + repeated(33, one_key)); }, {"sweep.toml:", ".count is one key too many", "32 at most"}) == "");
  CHECK(complaint_lacks([&] { parse(paper + "[[where]]\nset = { \"run.strain\" = 1 }\nmatch = { \"flow.capillary_number\" = [" + repeated(10'001, number) + "] }"); },
                        {"list of 10001 values", "at most 10000"}) == "");
  const auto rule = [](int i) { return fmt::format("[[where]]\nmatch = {{ flow.capillary_number = 0.081 }}\nset = {{ cells.{}.count = 1 }}\n", i); };
  CHECK(complaint_lacks([&] { parse(paper + repeated(101, rule)); }, {"sweep.toml:309: ", "more than 100 [[where]]"}) == "");
  CHECK(complaint_lacks([&] { parse(paper + repeated(31, rule)); }, {"sweep.toml:99: ", "phi0.12-Ca0.081 more than 32 overrides"}) == "");
  CHECK(complaint_lacks([&] { parse(scene + "[[also]]\nrun.packing = \"" + std::string(499, 'a') + "\""); }, {"sweep.toml:2: ", "501 characters", "500 at most"}) == "");
  // The most that is allowed: every point with keys of its own, all of them in its name or matched by every rule.
  const auto point = [](int i) {
    std::string text = "[[also]]\n";
    for (int k = 0; k < 12; ++k) text += fmt::format("cells.{}.count=1\n", 12 * i + k);
    return text;
  };
  CHECK(parse(scene + repeated(2'000, point)).points.size() == 2'000);
  std::string most = scene + repeated(31, one_axis) + "[[axis]]\nkey = \"run.seed\"\nvalues = [" + repeated(10'000, number) + "]\n", match;
  for (int i = 0; i < 31; ++i) match += fmt::format("cells.{}.count = 1, ", i);
  most += repeated(100, [&](int) { return "[[where]]\nmatch = { " + match + "run.seed = 5 }\nset = { run.strain = 1 }\n"; });
  CHECK(complaint_lacks([&] { parse(most); }, {"gives the point seed5 more than 32 overrides"}) == "");
  CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(60));
}

TEST_CASE("sweep: files are read as scenes are", "[sweep]") {
  const ScratchFolder folder;
  CHECK(complaint_lacks([&] { read_sweep((folder / "none.toml").string()); }, {"none.toml", "no such sweep file"}) == "");
  CHECK(complaint_lacks([&] { read_sweep((folder / "").string()); }, {"is a directory, not a sweep file"}) == "");
  std::ofstream(folder / "sweep.toml") << paper;
  const Sweep sweep = read_sweep((folder / "sweep.toml").string());
  CHECK(sweep.scene == (folder / "base.toml").string());
  CHECK(sweep.points.size() == 4);
}
