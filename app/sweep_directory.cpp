#include "app/sweep_directory.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "app/child_runs.hpp"
#include "app/output_directory.hpp"
#include "core/error.hpp"
#include "io/durable.hpp"
#include "io/scene.hpp"

namespace corpuscle::app {
namespace {

namespace fs = std::filesystem;

/// Whether a run has written anything into its directory.
bool has_begun(const fs::path& run) {
  std::error_code error;
  return fs::exists(run, error) && !fs::is_empty(run, error);
}

/// The scene that a run of this name has begun with, or would; nothing when there is none.
std::optional<Problem> known_scene(const SweepDirectory& directory, const std::string& name) {
  std::error_code ignored;
  for (const fs::path& path : {directory.scene(name), directory.run(name) / "scene.toml"})
    if (fs::exists(path, ignored)) return read_scene(path.string());
  return {};
}

/// A sentence about the point that would continue another scene.
std::string difference(const PlannedPoint& point, const std::optional<Problem>& known) {
  if (!known) return fmt::format("\n  {}: its directory holds files of something else", point.point.name);
  constexpr std::size_t most_told = 5;
  auto all = scene_differences(*known, point.problem, "there", "now");
  const std::size_t more = all.size() > most_told ? all.size() - most_told : 0;
  all.resize(all.size() - more);
  return fmt::format("\n  {}: {}{}", point.point.name, fmt::join(all, "; "), more > 0 ? fmt::format("; and {} more", more) : "");
}

}  // namespace

SweepDirectory::SweepDirectory(fs::path directory, const std::string& base_scene, std::vector<PlannedPoint>& points) : directory_(std::move(directory)), points_(points) {
  if (auto before = read_sweep_record(directory_)) record_ = std::move(*before);
  record_.scene = fs::absolute(base_scene).lexically_normal().string();
  constexpr std::size_t none = -1;
  run_of_.assign(points_.size(), none);

  // A run keeps its directory when the sweep gets another axis, with which names get longer: what counts is its scene.
  std::map<std::string, std::size_t> run_with_scene;
  for (std::size_t i = 0; i < record_.runs.size(); ++i)
    if (const auto known = known_scene(*this, record_.runs[i].name)) run_with_scene.emplace(to_toml(*known), i);
  std::set<std::size_t> taken;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const auto found = run_with_scene.find(to_toml(points_[i].problem));
    if (found == run_with_scene.end() || !taken.insert(found->second).second) continue;
    run_of_[i] = found->second;
    points_[i].point.name = record_.runs[found->second].name;
    record_.runs[found->second].overrides = points_[i].point.overrides;
  }

  std::vector<std::string> refused;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (run_of_[i] != none) continue;
    const PlannedPoint& point = points_[i];
    const auto named = std::find_if(record_.runs.begin(), record_.runs.end(), [&](const SweepRun& run) { return run.name == point.point.name; });
    const auto at = static_cast<std::size_t>(named - record_.runs.begin());
    const bool is_new = named == record_.runs.end();
    if (has_begun(run(point.point.name)) || taken.contains(at)) {
      const auto there = known_scene(*this, point.point.name);
      if (!there || to_toml(*there) != to_toml(point.problem)) refused.push_back(difference(point, there));
    }
    run_of_[i] = at;
    taken.insert(at);
    const SweepRun waiting{point.point.name, point.point.overrides, RunState::waiting, {}, ""};
    if (is_new) record_.runs.push_back(waiting);
    else *named = waiting;
  }
  if (!refused.empty())
    throw InputError(fmt::format("--output {}: {} of {} points have begun with other settings, so nothing was started: take the change back, choose another --output, "
                                 "or remove these runs and their files in {}/scenes:{}",
                                 directory_.string(), refused.size(), points_.size(), directory_.string(), fmt::join(refused, "")));
  for (std::size_t i = 0; i < points_.size(); ++i) refresh(run_of_[i], points_[i].lattice.steps);
}

void SweepDirectory::refresh(std::size_t run, std::int64_t steps) {
  SweepRun& r = record_.runs[run];
  update(r, look_at_run(this->run(r.name)), steps);
  if (r.state != RunState::failed || !r.message.empty()) return;
  r.message = last_error(log(r.name));
  if (r.message.empty()) r.message = "A guard stopped the run";
}

void SweepDirectory::write() {
  create_output_directory(directory_ / "scenes");
  create_output_directory(directory_ / "logs");
  for (const PlannedPoint& point : points_) {
    const fs::path path = scene(point.point.name);
    std::error_code ignored;
    if (!has_begun(run(point.point.name)) || !fs::exists(path, ignored)) replace_file(path, to_toml(point.problem), "the scene");
  }
  write_record();
}

std::vector<std::string> SweepDirectory::left_over() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < record_.runs.size(); ++i)
    if (std::find(run_of_.begin(), run_of_.end(), i) == run_of_.end()) names.push_back(record_.runs[i].name);
  return names;
}

}  // namespace corpuscle::app
