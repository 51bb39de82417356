#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <vector>

#include "app/commands.hpp"
#include "app/output_directory.hpp"
#include "app/replaced_results.hpp"
#include "app/time_loop.hpp"
#include "core/error.hpp"
#include "io/lock.hpp"
#include "io/packing_file.hpp"
#include "io/progress.hpp"
#include "io/scene.hpp"
#include "physics/packing.hpp"

namespace corpuscle::app {
namespace {

namespace fs = std::filesystem;

/// Refuses directories that hold results, unless they are to be replaced.
void require_no_results(const fs::path& directory, bool overwrite) {
  if (overwrite) return;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(directory, error)) {
    const std::string name = entry.path().filename().string();
    if (is_result(name) && name != "packing.h5" && name != "scene.toml")  // these two may well be what the run starts from
      throw InputError(fmt::format("--output {} holds the results of an earlier run ({}); "
                                   "choose another directory, add --overwrite to replace them, or go on with corpuscle resume.",
                                   directory.string(), name));
  }
}

/// Removes what this run has written, but not the packing that it starts from.
void remove_outputs(const fs::path& directory, const fs::path& packing_in_use) {
  std::error_code error, differs;
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(directory, error))
    if (is_result(entry.path().filename().string())) paths.push_back(entry.path());
  for (const auto& path : paths)
    if (packing_in_use.empty() || !fs::equivalent(path, packing_in_use, differs)) fs::remove(path, error);
}

/// Packs with a line that tells how far it is: redrawn on a terminal, every tenth in a log.
std::vector<double> pack(const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types, const WallTime& wall_time) {
  const bool terminal = stream_is_terminal(stdout);
  int shown = -1;
  const auto positions = place_cells(problem, lattice, types, [&](double scale, double gap, int rounds) {
    const int percent = int(100 * scale);
    if (terminal)
      std::cout << fmt::format("\rpacking: cells at {:3d} % of their size, smallest gap {:.2f} lattice units, round {} ", percent, gap, rounds) << std::flush;
    else if (percent / 10 > shown)
      std::cout << fmt::format("packing: cells at {} % of their size, round {}\n", percent, rounds) << std::flush;
    shown = std::max(shown, percent / 10);
    return signal_received() == Stop::none && !wall_time.over(0);
  });
  if (terminal && shown >= 0) std::cout << "\n";
  return positions;
}

}  // namespace

int run(const RunOptions& options) {
  const fs::path directory = options.output;
  const WallTime wall_time(options.wall_time.empty() ? 0 : parse_wall_time(options.wall_time));
  const Problem problem = read_scene(options.scene, options.overrides);
  const LatticeParameters lattice = to_lattice(problem);
  require_writable(directory);
  require_no_results(directory, options.overwrite);
  print_warnings(lattice.warnings);
  const auto types = make_cell_types(problem, lattice);
  Packing packing = packing_layout(lattice);
  const bool packed_before = !problem.run.packing.empty();
  if (packed_before) packing = load_packing(problem.run.packing, packing);

  listen_to_signals();
  const KokkosSession session(options.threads);
  try {
    if (!packed_before) packing.positions = pack(problem, lattice, types, wall_time);
  } catch (const InputError&) {
    if (signal_received() == Stop::none && !wall_time.over(0)) throw;
    std::cerr << "error: Stopped while packing; nothing was written." << std::endl;
    return exit_code::interrupted;
  }

  // Before anything old is removed: this is where memory runs out.
  const auto suspension = make_suspension(problem, lattice, types, packing.positions);
  if (packs_cells(problem, types)) suspension->settle();
  SeriesSummary series(lattice, problem.run.discard);
  auto statistics = live_statistics(problem, lattice);
  Checkpoints checkpoints(directory, problem, lattice);
  std::error_code error;
  const bool existed = fs::exists(directory, error);
  create_output_directory(directory);
  std::optional<DirectoryLock> lock;
  std::optional<ReplacedResults> replaced;
  std::optional<Outputs> created;
  try {
    lock.emplace(directory);
    require_no_results(directory, options.overwrite);  // another run may have come and gone while this one was packing
    replaced.emplace(directory, problem.run.packing);
    std::ofstream scene(directory / "scene.toml");
    if (!(scene << to_toml(problem) << std::flush)) throw OutputError((directory / "scene.toml").string() + " can't be written (is the disk full?)");
    if (!packed_before && !types.empty()) save_packing(directory / "packing.h5", packing);
    created.emplace(directory, problem, lattice, types);
    try {
      checkpoints.write(*suspension, *created, series, statistics, 0, 0);  // from now on, whatever happens, the run can be resumed
    } catch (const SimulationError&) {  // a broken start: the time loop finds it too, and says so with the state for inspection
    }
  } catch (const OutputError& failed) {  // nothing has been computed: leave nothing behind
    if (replaced) {
      remove_outputs(directory, problem.run.packing);
      replaced->restore();
    }
    lock.reset();
    if (!existed) fs::remove(directory, error);
    throw InputError(fmt::format("--output {}: {}; make room or choose another place.", directory.string(), failed.what()));
  }
  replaced->discard();
  packing.positions = {};
  return run_to_end({directory, problem, lattice, *suspension, *created, series, statistics, checkpoints, 0, 0, wall_time, options.profile});
}

}  // namespace corpuscle::app
