#include "io/sweep_record.hpp"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/version.hpp"
#include "io/checkpoint.hpp"
#include "io/durable.hpp"
#include "io/lock.hpp"

namespace corpuscle {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* format_name = "corpuscle-sweep-1";
constexpr std::array state_names{"waiting", "running", "finished", "failed", "stopped"};

SweepRun read_run(const Json& json) {
  SweepRun run;
  run.name = json.at("name");
  for (const auto& [key, value] : json.at("overrides").items()) run.overrides.push_back({key, value.dump()});
  const std::string state = json.at("state");
  const auto found = std::find(state_names.begin(), state_names.end(), state);
  if (found == state_names.end()) throw std::runtime_error("the state " + state + " isn't known");
  run.state = static_cast<RunState>(found - state_names.begin());
  if (!json.at("exit_code").is_null()) run.exit_code = json.at("exit_code").get<int>();
  run.message = json.at("message");
  return run;
}

}  // namespace

const char* name_of(RunState state) { return state_names.at(static_cast<std::size_t>(state)); }

std::optional<SweepRecord> read_sweep_record(const fs::path& directory) {
  const fs::path path = directory / "sweep.json";
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return {};
  std::ifstream file(path);
  try {
    const Json json = Json::parse(file);
    if (json.at("format") != format_name) throw std::runtime_error("its format isn't " + std::string(format_name));
    SweepRecord record;
    record.scene = json.at("scene");
    for (const Json& run : json.at("runs")) record.runs.push_back(read_run(run));
    return record;
  } catch (const std::exception& error) {
    throw InputError(fmt::format("{} can't be read as the record of a sweep ({}): remove it, and the runs that are there are taken up again, or choose another --output",
                                 path.string(), error.what()));
  }
}

void write_sweep_record(const fs::path& directory, const SweepRecord& record) {
  Json json;
  json["format"] = format_name;
  json["version"] = version_string();
  json["git_revision"] = git_revision();
  json["scene"] = record.scene;
  json["runs"] = Json::array();
  for (const SweepRun& run : record.runs) {
    Json overrides = Json::object();
    for (const Override& o : run.overrides) overrides[o.key] = Json::parse(o.value);
    json["runs"].push_back({{"name", run.name}, {"directory", run.name}, {"overrides", overrides}, {"state", name_of(run.state)},
                            {"exit_code", run.exit_code ? Json(*run.exit_code) : Json()}, {"message", run.message}});
  }
  replace_file(directory / "sweep.json", json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n", "the record of the sweep");
}

RunCondition look_at_run(const fs::path& directory) {
  RunCondition found;
  found.writer = lock_holder(directory);
  std::error_code ignored;
  for (const char* name : CheckpointStore::names) found.has_checkpoint = found.has_checkpoint || fs::exists(directory / name, ignored);
  std::ifstream file(directory / "summary.json");
  const Json summary = Json::parse(file, nullptr, false);
  if (!summary.is_object() || !summary.contains("stopped_by") || !summary["stopped_by"].is_string()) return found;
  found.stopped_by = summary["stopped_by"];
  found.steps = summary.value("steps", std::int64_t{0});
  return found;
}

void update(SweepRun& run, const RunCondition& found, std::int64_t steps) {
  const auto become = [&](RunState state, std::optional<int> code, const char* message) {
    if (run.state == state && run.exit_code == code) return;  // keeps what is known better
    run.state = state;
    run.exit_code = code;
    run.message = message;
  };
  if (!found.writer.empty()) become(RunState::running, {}, "");
  else if (found.stopped_by == "end" && found.steps >= steps) become(RunState::finished, exit_code::success, "");
  else if (found.stopped_by == "guard") become(RunState::failed, exit_code::broken_run, "");
  else if (run.state == RunState::failed && run.exit_code != exit_code::broken_run) return;
  else if (found.has_checkpoint) {
    if (run.state != RunState::stopped) become(RunState::stopped, {}, "");
  } else if (run.state == RunState::finished || run.state == RunState::failed) become(RunState::waiting, {}, "");  // its directory has been removed
  else if (run.state == RunState::running) become(RunState::stopped, {}, "");  // killed before its first checkpoint
}

}  // namespace corpuscle
