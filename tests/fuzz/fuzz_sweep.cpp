// Any text as a sweep: it's refused with InputError, or gives a bounded list of points whose names are directories of their own, and whose overrides say in
// TOML and in JSON what they are.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "core/error.hpp"
#include "io/sweep.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace corpuscle;

bool fit_for_a_directory(const std::string& name) {
  const auto fits = [](char c) { return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '.' || c == '-' || c == '+' || c == '_'; };
  return !name.empty() && name.size() <= 200 && name[0] != '.' && std::all_of(name.begin(), name.end(), fits);
}

/// A sweep of this point alone, written from what was read.
std::string alone(const SweepPoint& point) {
  std::string text = "scene = \"base.toml\"\n[[also]]\n";
  for (const Override& o : point.overrides) text += "\"" + o.key + "\" = " + o.value + "\n";
  return text;
}

std::set<std::string> texts(const SweepPoint& point) {
  std::set<std::string> list;
  for (const Override& o : point.overrides) list.insert(o.text());
  return list;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(bytes), size);
  Sweep sweep;
  try {
    sweep = parse_sweep(text, "folder/sweep.toml");
  } catch (const InputError&) {
    return 0;
  }
  CORPUSCLE_REQUIRE(!sweep.scene.empty());
  CORPUSCLE_REQUIRE(!sweep.points.empty() && sweep.points.size() <= most_sweep_points);
  std::set<std::string> names;
  for (const SweepPoint& point : sweep.points) {
    CORPUSCLE_REQUIRE(fit_for_a_directory(point.name) && names.insert(point.name).second);
    CORPUSCLE_REQUIRE(texts(point).size() == point.overrides.size());
    for (const Override& o : point.overrides) CORPUSCLE_REQUIRE(nlohmann::json::accept(o.value));
  }
  for (const SweepPoint* point : {&sweep.points.front(), &sweep.points.back()}) {
    const Sweep again = parse_sweep(alone(*point), "again.toml");
    CORPUSCLE_REQUIRE(again.points.size() == 1 && texts(again.points[0]) == texts(*point));
  }
  const Sweep same = parse_sweep(text, "folder/sweep.toml");
  CORPUSCLE_REQUIRE(same.scene == sweep.scene && same.points.size() == sweep.points.size());
  for (std::size_t i = 0; i < sweep.points.size(); ++i)
    CORPUSCLE_REQUIRE(same.points[i].name == sweep.points[i].name && same.points[i].overrides == sweep.points[i].overrides);
  return 0;
}
