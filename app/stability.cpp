// corpuscle stability: finds the limits between stable and unstable, compares them with the linear estimate, keeps them in stability.json.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>

#include "app/commands.hpp"
#include "app/output_directory.hpp"
#include "app/stability_cases.hpp"
#include "core/error.hpp"
#include "core/version.hpp"
#include "io/durable.hpp"

namespace corpuscle::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The results so far; empty when there are none. @throws InputError when the file is something else.
Json read_results(const fs::path& file) {
  Json results = {{"command", "corpuscle stability"}, {"cases", Json::array()}};
  if (!fs::exists(file)) return results;
  std::ifstream in(file);
  const Json read = Json::parse(in, nullptr, false);
  if (read.is_discarded() || !read.contains("cases") || !read["cases"].is_array())
    throw InputError(fmt::format("{} is no result of corpuscle stability: remove it or choose another --output", file.string()));
  return read;
}

Json search(const StabilityCase& c, Prober& prober) {
  const Kokkos::Timer timer;
  Json probes = Json::array();
  const LimitBracket bracket = find_limit(c.search, [&](double value) {
    ProbeScene scene = c.scene;
    c.set(scene, value);
    const StabilityVerdict v = prober.probe(scene);
    probes.push_back({{"value", c.shown(value)}, {"stable", v.stable}, {"growth_rate", v.growth_rate}, {"jitter", v.jitter}, {"steps", v.steps}, {"reason", v.reason}});
    return v.stable;
  });
  Json row;
  row["parameter"] = c.parameter;
  row["conditions"] = c.conditions;
  row["unit"] = c.unit;
  row["scene"] = c.scene.kind == ProbeScene::Kind::at_rest ? "at rest" : c.scene.kind == ProbeScene::Kind::in_flow ? "in flow" : "fluid alone";
  row["delta_kernel"] = c.scene.delta_kernel;
  row["relaxation_time"] = c.scene.relaxation_time;
  row["edge"] = c.scene.edge;
  row["radius"] = c.scene.radius;
  row["phi_effective"] = c.scene.kind == ProbeScene::Kind::in_flow ? Json(c.scene.phi) : Json();
  row["smallest"] = c.smallest;
  row["stable"] = std::isnan(bracket.good) ? Json() : Json(c.shown(bracket.good));  // null: none was
  row["unstable"] = std::isfinite(bracket.bad) ? Json(c.shown(bracket.bad)) : Json();
  row["limit"] = bracket.limit() > 0 ? Json(c.shown(bracket.limit())) : Json();
  const bool elastic = c.unit == "eta_0" && c.parameter != "contact" && c.scene.kind != ProbeScene::Kind::fluid_only;
  if (elastic && bracket.limit() > 0 && std::isfinite(bracket.bad)) {
    ProbeScene scene = c.scene;
    c.set(scene, bracket.limit());
    row["response"] = prober.response(scene);
  }
  row["probes"] = std::move(probes);
  row["seconds"] = timer.seconds();
  return row;
}

std::string line(const Json& row) {
  const auto number = [&](const char* key) { return row[key].is_null() ? std::string("-") : fmt::format("{:.4g}", row[key].get<double>()); };
  return fmt::format("{:<12} {:<62} {:>9} {:>9} {:<9} {:>9} {:6.1f} s", row["parameter"].get<std::string>(), row["conditions"].get<std::string>(), number("stable"),
                     number("unstable"), row["unit"].get<std::string>(), row.contains("response") ? number("response") : "", row["seconds"].get<double>());
}

}  // namespace

int stability(const StabilityOptions& options) {
  auto cases = stability_cases();
  std::set<std::string> known;
  for (const auto& c : cases) known.insert(c.parameter);
  for (const auto& wanted : options.only)
    if (!known.contains(wanted)) throw InputError(fmt::format("--only {} is no parameter of the search; the parameters are {}", wanted, fmt::join(known, ", ")));
  const fs::path directory = options.output, file = directory / "stability.json";
  create_output_directory(directory);
  Json results = read_results(file);
  results["version"] = version_string();
  std::set<std::string> done;
  for (const auto& row : results["cases"]) done.insert(row["parameter"].get<std::string>() + " | " + row["conditions"].get<std::string>());

  const KokkosSession session(options.threads);
  Prober prober;
  fmt::print("{:<12} {:<62} {:>9} {:>9} {:<9} {:>9}\n", "parameter", "conditions", "stable", "unstable", "unit", "response");
  for (const auto& c : cases) {
    if (!options.only.empty() && std::find(options.only.begin(), options.only.end(), c.parameter) == options.only.end()) continue;
    if (c.conditions.find(options.conditions) == std::string::npos || done.contains(c.id())) continue;
    results["cases"].push_back(search(c, prober));
    replace_file(file, results.dump(1) + "\n", "the results");  // an interrupted search leaves a whole file
    std::cout << line(results["cases"].back()) << std::endl;
  }
  fmt::print("results in {}; figure and docs/stability.md: python report/stability.py {}\n", file.string(), file.string());
  return 0;
}

}  // namespace corpuscle::app
