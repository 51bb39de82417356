#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <optional>

#include "app/commands.hpp"
#include "app/time_loop.hpp"
#include "core/error.hpp"
#include "core/version.hpp"
#include "io/durable.hpp"
#include "io/lock.hpp"
#include "io/scene.hpp"

namespace corpuscle::app {
namespace {

namespace fs = std::filesystem;

/// The scene of a checkpoint with the changes that the command line asks for.
Problem scene_of(const CheckpointFile& file, const fs::path& directory, const std::vector<std::string>& changes) {
  const std::string origin = (directory / "scene.toml").string();
  try {
    return parse_scene(file.contents().scene, origin, changes);
  } catch (const InputError&) {
    // The packing that the run started from may be gone: it isn't needed any more.
    auto without_packing = changes;
    without_packing.push_back("run.packing=\"\"");
    return parse_scene(file.contents().scene, origin, without_packing);
  }
}

std::vector<std::string> changes_of(const ResumeOptions& options) {
  std::vector<std::string> changes;
  if (!options.until.empty()) {
    const std::string key = options.until.substr(0, options.until.find('='));
    if (key != "strain" && key != "steps" && key != "duration")
      throw InputError(fmt::format("--until {} must be strain=X, steps=N or duration=X, for example --until strain=20", options.until));
    changes.push_back("run." + options.until);
  }
  for (const auto& change : options.overrides) {
    if (!change.starts_with("guards.") && !change.starts_with("output.checkpoint_"))
      throw InputError(fmt::format("--set {} would make another run of it: only guards.KEY and output.checkpoint_KEY can be set when a run is resumed; "
                                   "start a new one with corpuscle run", change));
    changes.push_back(change);
  }
  if (!options.precision.empty()) changes.push_back("accuracy.precision=" + options.precision);
  return changes;
}

/// Cadences at rest are in the unit of the run's length: another unit would change what is measured when.
void check_unit_of_length(const Problem& before, const Problem& now) {
  if (before.flow.kind == FlowKind::rest && before.run.duration.has_value() != now.run.duration.has_value())
    throw InputError(fmt::format("--until must give the length in the scene's unit at rest, run.{}: use --until {}", before.run.duration ? "duration" : "steps",
                                 before.run.duration ? "duration=X" : "steps=N"));
}

void check_same_lattice(const CheckpointFile& file, const LatticeParameters& lattice) {
  if (lattice_numbers(lattice) == file.contents().lattice && lattice.nodes == file.contents().nodes) return;
  throw InputError(fmt::format("{} was written by version {} ({}), for whose scene this version ({}, {}) chooses other lattice parameters: "
                               "go on with that version, or fix accuracy.shear_rate and accuracy.shear_modulus in a new run",
                               file.path().string(), file.contents().version, file.contents().git_revision, version_string(), git_revision()));
}

/// scene.toml and run.h5 say what the run is now.
void state_length(const fs::path& directory, const Problem& problem, const LatticeParameters& lattice, Outputs& outputs) {
  replace_file(directory / "scene.toml", to_toml(problem), "the scene");
  outputs.set_length(to_toml(problem), lattice.steps);
}

}  // namespace

int resume(const ResumeOptions& options) {
  const fs::path directory = options.directory;
  const WallTime wall_time(options.wall_time.empty() ? 0 : parse_wall_time(options.wall_time));
  const auto changes = changes_of(options);
  listen_to_signals();  // a large checkpoint takes its time to be read
  std::vector<std::string> notes;
  std::optional<DirectoryLock> lock;
  if (std::error_code error; fs::is_directory(directory, error)) lock.emplace(directory);
  const CheckpointFile file = open_newest_checkpoint(directory, notes);
  const Checkpoint& from = file.contents();
  const Problem before = scene_of(file, directory, {});
  const Problem problem = scene_of(file, directory, changes);
  check_unit_of_length(before, problem);
  const LatticeParameters lattice = to_lattice(problem);
  check_same_lattice(file, lattice);
  if (lattice.steps < from.state.step)
    throw InputError(fmt::format("--until {}: the run is already at step {}, beyond step {}; give a larger value", options.until, from.state.step,
                                 lattice.steps));
  const bool converts = (problem.accuracy.precision == Precision::double_precision) != file.double_precision();
  if (converts)
    notes.push_back(fmt::format("The fluid goes on in {} precision: from here on the run isn't the one that it would have been, bit for bit",
                                options.precision));
  print_warnings(notes);

  const KokkosSession session(options.threads);
  const auto types = make_cell_types(problem, lattice);
  std::int64_t vertices = 0;
  for (const auto& type : types) vertices += std::int64_t(type.count) * type.vertices();
  if (from.state.positions.size() != 3 * std::size_t(vertices))
    throw InputError(fmt::format("{} holds {} vertices, but the scene has {}: was the cells' mesh file changed?", file.path().string(),
                                 from.state.positions.size() / 3, vertices));
  const auto suspension = make_suspension(problem, lattice, types, from.state.positions);
  suspension->restore(from.state, [&](int direction) { return file.population(direction); });
  if (!changes.empty()) suspension->check();  // before any file says that the new limits hold
  SeriesSummary series(lattice, problem.run.discard);
  series.restore(from.summary);
  auto statistics = live_statistics(problem, lattice);
  if (statistics) statistics->restore(from.statistics);
  Outputs outputs = Outputs::resume(directory, problem, lattice, types, from.state.step);
  Checkpoints checkpoints(directory, problem, lattice);
  checkpoints.go_on_after(file);
  std::cout << fmt::format("going on at step {} of {}, from {}", from.state.step, lattice.steps, file.path().filename().string()) << std::endl;
  if (to_toml(problem) != from.scene) {
    // From now on this is the scene, also when the run is killed before its next checkpoint.
    state_length(directory, problem, lattice, outputs);
    checkpoints.forget_last();
    checkpoints.write(*suspension, outputs, series, statistics, from.state.step, from.seconds);
  }
  return run_to_end({directory, problem, lattice, *suspension, outputs, series, statistics, checkpoints, from.state.step, from.seconds, wall_time, options.profile});
}

}  // namespace corpuscle::app
