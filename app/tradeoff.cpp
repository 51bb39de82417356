// corpuscle tradeoff: a study of error against cost. Its runs are those of a sweep; what they show is compared with a reference.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "app/analyse.hpp"
#include "app/commands.hpp"
#include "app/machine.hpp"
#include "app/sweep_directory.hpp"
#include "app/sweep_points.hpp"
#include "core/error.hpp"
#include "core/version.hpp"
#include "io/analysis_file.hpp"
#include "io/durable.hpp"
#include "io/sweep_analysis.hpp"
#include "io/tradeoff.hpp"
#include "physics/resolution_error.hpp"

namespace corpuscle::app {
namespace {

namespace fs = std::filesystem;
using statistics::Estimate;

/// What one run of a study tells.
struct RunOfStudy {
  std::string directory, state, message;
  std::vector<Estimate> observed;
  double measured = statistics::not_a_number;  ///< core seconds a unit of strain
};

/// Core seconds a unit of strain, from summary.json.
double measured_cost(const fs::path& run) {
  std::ifstream file(run / "summary.json");
  const auto json = nlohmann::json::parse(file, nullptr, false);
  if (!json.is_object()) return statistics::not_a_number;
  const auto number = [&](const char* key) { return json.contains(key) && json[key].is_number() ? json[key].get<double>() : statistics::not_a_number; };
  return number("wall_seconds") * number("threads") / number("strain");
}

RunOfStudy look_at(const SweepDirectory& directory, const SweepRun& run, const Study& study) {
  RunOfStudy result{run.name, name_of(run.state), run.message, std::vector<Estimate>(study.observables.size(), Estimate{.reason = name_of(run.state)}), statistics::not_a_number};
  if (run.state != RunState::finished) return result;
  analysis::AnalysisOptions choices;
  choices.wall_layer = study.wall_layer;
  if (study.discard) choices.discard = *study.discard;
  try {
    const auto json = analysed(directory.run(run.name), choices);
    for (std::size_t o = 0; o < study.observables.size(); ++o) result.observed[o] = estimate_of(json, study.observables[o]);
    result.measured = measured_cost(directory.run(run.name));
  } catch (const InputError& error) {
    result.state = "not analysed";
    result.message = error.what();
  } catch (const nlohmann::json::exception& error) {
    result.state = "not analysed";
    result.message = error.what();
  }
  return result;
}

std::string machine() { return fmt::format("{}, {} cores", cpu_model(), cpu_cores()); }

/// Costs of points, by name, that an earlier look at the study found with this program on this machine: measuring them takes seconds each.
std::map<std::string, double> known_costs(const fs::path& output) {
  std::map<std::string, double> costs;
  std::ifstream file(output);
  const auto json = nlohmann::json::parse(file, nullptr, false);
  try {
    if (!json.is_object() || json.at("machine") != machine() || json.at("version") != version_string() || json.at("git_revision") != git_revision()) return costs;
    for (const auto& point : json.at("points")) {
      const auto& predicted = point.at("core_seconds_per_strain").at("predicted");
      if (predicted.is_number()) costs[point.at("name")] = predicted;
    }
  } catch (const nlohmann::json::exception&) {
  }
  return costs;
}

/// Core seconds a unit of strain of every point, predicted for this machine.
std::vector<double> predicted_costs(const std::vector<PlannedPoint>& points, const fs::path& output) {
  const auto known = known_costs(output);
  std::vector<const PlannedPoint*> unknown;
  for (const PlannedPoint& p : points)
    if (!known.contains(p.point.name)) unknown.push_back(&p);
  const auto seconds = seconds_per_step(unknown, std::vector<int>(unknown.size(), 1));
  std::vector<double> costs;
  std::size_t next = 0;
  for (const PlannedPoint& p : points) costs.push_back(known.contains(p.point.name) ? known.at(p.point.name) : seconds[next++] * p.lattice.steps_per_strain);
  return costs;
}

std::vector<StudyEntry> collect(const Study& study, const SweepDirectory& directory, const std::vector<PlannedPoint>& points, const std::vector<RefusedPoint>& refused) {
  const std::vector<double> costs = predicted_costs(points, directory.path() / "tradeoff.json");
  // Numbers of the planned points, by the points of the study.
  std::vector<std::ptrdiff_t> planned(study.sweep.points.size(), 0);
  for (const RefusedPoint& r : refused) planned[r.point] = -1;
  std::ptrdiff_t next = 0;
  for (auto& p : planned)
    if (p == 0) p = next++;

  std::vector<StudyEntry> entries;
  const auto groups = repeats_of(study);
  for (const auto& group : groups) {
    StudyEntry entry;
    entry.point.name = study.sweep.points[group.front()].name;
    entry.point.settings = study.settings[group.front()];
    entry.state = "finished";
    std::vector<std::vector<Estimate>> observed(study.observables.size());
    std::vector<double> measured;
    const auto stands = [&](const std::string& state, const std::string& message) {
      if (entry.state != "finished") return;
      entry.state = state;
      entry.message = message;
    };
    for (const std::size_t i : group) {
      if (planned[i] < 0) {
        const auto found = std::find_if(refused.begin(), refused.end(), [&](const RefusedPoint& r) { return r.point == i; });
        stands("refused", found->reason);
        continue;
      }
      const auto at = static_cast<std::size_t>(planned[i]);
      const PlannedPoint& p = points[at];
      if (entry.runs.empty()) entry.point.name = p.point.name;
      const RunOfStudy run = look_at(directory, directory.record().runs[directory.run_of(at)], study);
      entry.runs.push_back(run.directory);
      if (run.state != "finished") stands(run.state, run.message);
      else measured.push_back(run.measured);
      for (std::size_t o = 0; o < observed.size(); ++o)
        if (run.state == "finished") observed[o].push_back(at_fraction(run.observed[o], study.observables[o], counted_fraction(p.problem, p.lattice), study.fraction));
      entry.nodes = p.lattice.box_volume();
      entry.vertices = double(p.lattice.vertices());
      entry.steps_per_strain = p.lattice.steps_per_strain;
      entry.point.cost = costs[at];
    }
    if (!measured.empty()) {  // some of the repeats are enough
      entry.state = "finished";
      entry.measured = 0;
      for (const double cost : measured) entry.measured += cost / double(measured.size());
    }
    for (const auto& values : observed) entry.point.observed.push_back(tradeoff::mean_of_repeats(values));
    entries.push_back(std::move(entry));
  }
  return entries;
}

void print_refused(const Study& study, const std::vector<RefusedPoint>& refused) {
  for (const RefusedPoint& r : refused) std::cout << fmt::format("{} can't be run: {}\n", study.sweep.points[r.point].name, r.reason);
}

}  // namespace

int tradeoff(const TradeoffOptions& options) {
  const Study study = read_study(options.sweep);
  std::vector<RefusedPoint> refused;
  std::vector<PlannedPoint> points = plan_points(study.sweep, &refused);
  const fs::path output = fs::path(options.output) / "tradeoff.json";
  require_replaceable(output, tradeoff_format, {".csv", ".md"});
  print_refused(study, refused);
  int code = exit_code::success;
  if (!options.no_run) {
    code = run_points(study.sweep.scene, points, options);
    if (options.dry_run || options.job_array) return code;
  }
  const SweepDirectory directory(options.output, study.sweep.scene, points);
  StudyResult result = evaluate(study, collect(study, directory, points, refused));
  result.machine = machine();
  const bool any = std::any_of(result.entries.begin(), result.entries.end(), [](const StudyEntry& entry) { return entry.state == "finished"; });
  if (!any) {
    if (options.no_run) throw InputError(fmt::format("{} has no finished run of this study: leave --no-run out to run it", options.output));
    return code;
  }
  const std::string page = tradeoff_page(result);
  replace_file(fs::path(output).replace_extension(".md"), page, "the page of the study");
  replace_file(fs::path(output).replace_extension(".csv"), tradeoff_csv(result), "the table of the study");
  replace_file(output, tradeoff_json(result).dump(1) + "\n", "the study");
  std::cout << page << "\nresults in " << output.string() << "\n";
  return code;
}

}  // namespace corpuscle::app
