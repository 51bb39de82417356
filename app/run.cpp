#include <fmt/format.h>
#include <unistd.h>

#include <Kokkos_Profiling_ScopedRegion.hpp>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>

#include "app/commands.hpp"
#include "app/machine.hpp"
#include "app/profile.hpp"
#include "app/replaced_results.hpp"
#include "core/error.hpp"
#include "core/version.hpp"
#include "io/lock.hpp"
#include "io/output_check.hpp"
#include "io/packing_file.hpp"
#include "io/progress.hpp"
#include "io/run_file.hpp"
#include "io/scene.hpp"
#include "io/summary.hpp"
#include "io/vtkhdf.hpp"
#include "physics/packing.hpp"
#include "physics/suspension.hpp"

namespace corpuscle::app {
namespace {

namespace fs = std::filesystem;

std::atomic<bool> interrupted{false};
extern "C" void on_signal(int) { interrupted = true; }

/// Refuses directories that hold results or cannot be written; creates nothing.
void check_output(const fs::path& directory, bool overwrite, bool locked_by_this_run = false) {
  std::error_code error;
  fs::path existing = fs::absolute(directory);
  while (!existing.empty() && !fs::exists(existing, error)) existing = existing.parent_path();
  if (!fs::is_directory(existing, error))
    throw InputError(fmt::format("--output {}: {} is not a directory; choose another place.", directory.string(), existing.string()));
  if (access(existing.c_str(), W_OK | X_OK) != 0)
    throw InputError(fmt::format("--output {}: no permission to write in {}; choose another place.", directory.string(), existing.string()));
  if (!locked_by_this_run) require_unlocked(directory);
  for (const char* name : {"run.h5", "summary.json", "cells.vtkhdf", "fluid.vtkhdf"})
    if (!overwrite && fs::exists(directory / name, error))
      throw InputError(fmt::format("--output {} holds the results of an earlier run ({}); choose another directory, or add --overwrite to replace them.", directory.string(), name));
}

/// Removes the results of an earlier run, except the packing that this run starts from.
void remove_outputs(const fs::path& directory, const fs::path& packing_in_use) {
  std::error_code error;
  for (const char* name : {"run.h5", "summary.json", "cells.vtkhdf", "fluid.vtkhdf", "packing.h5", "scene.toml"})
    if (packing_in_use.empty() || !fs::equivalent(directory / name, packing_in_use, error)) fs::remove(directory / name, error);
}

/// Packs with a line that tells how far it is: redrawn on a terminal, every tenth in a log.
std::vector<double> pack(const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types, bool terminal) {
  int shown = -1;
  const auto positions = place_cells(problem, lattice, types, [&](double scale, double gap, int rounds) {
    const int percent = int(100 * scale);
    if (terminal)
      std::cout << fmt::format("\rpacking: cells at {:3d} % of their size, smallest gap {:.2f} lattice units, round {} ", percent, gap, rounds) << std::flush;
    else if (percent / 10 > shown)
      std::cout << fmt::format("packing: cells at {} % of their size, round {}\n", percent, rounds) << std::flush;
    shown = std::max(shown, percent / 10);
    return !interrupted;
  });
  if (terminal && shown >= 0) std::cout << "\n";
  return positions;
}

/// Everything that a run writes.
class Outputs {
 public:
  Outputs(const fs::path& directory, const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types)
      : file_(directory / "run.h5",
              RunMetadata{to_toml(problem), version_string(), git_revision(), cpu_model(), cpu_cores(), operating_system(), kokkos_configuration()}, lattice,
              RunFileOptions{.trajectories = problem.output.trajectories && !types.empty()}) {
    VtkDomain domain;
    for (int k = 0; k < 3; ++k) domain.size[k] = lattice.nodes[k];
    domain.periodic[2] = !problem.box.walls;
    domain.radius = lattice.radius;
    domain.at_rest = problem.flow.kind == FlowKind::rest;
    if (lattice.snapshot_every > 0 && !types.empty()) {
      std::vector<VtkCellType> surfaces;
      for (const auto& t : types) surfaces.push_back({t.name, t.reference.faces, t.vertices(), t.count});
      cells_.emplace(directory / "cells.vtkhdf", std::move(surfaces), domain);
    }
    if (lattice.snapshot_every > 0 && problem.output.fluid) fluid_.emplace(directory / "fluid.vtkhdf", lattice.nodes, domain);
  }
  void series(const Sample& sample) {
    const Kokkos::Profiling::ScopedRegion region("write_series");
    file_.append(sample);
  }
  void snapshot(const Suspension& suspension) {
    if (!cells_ && !fluid_) return;
    const Kokkos::Profiling::ScopedRegion region("write_snapshot");
    const Snapshot s = suspension.snapshot(fluid_.has_value());
    if (cells_) cells_->append(s);
    if (fluid_) fluid_->append(s);
  }
  void flush() {
    const Kokkos::Profiling::ScopedRegion region("write_series");
    file_.flush();
  }

 private:
  RunFile file_;
  std::optional<VtkHdfPolyData> cells_;
  std::optional<VtkHdfImage> fluid_;
};

/// How the time loop ended.
struct RunEnd {
  std::int64_t steps = 0;
  double seconds = 0;
  int code = exit_code::success;
  std::string stopped_by = "end";
  std::string failure;  ///< message for the user; empty when all went well
};

/// The time loop: steps, samples, snapshots, progress, guards, until the end, a signal or a failure.
RunEnd simulate(const LatticeParameters& lattice, Suspension& suspension, Outputs& outputs, SeriesSummary& series, bool terminal) {
  constexpr std::int64_t guard_every = 500;    // steps, where samples are further apart: a broken run must not go on for long
  constexpr std::int64_t progress_every = 32;
  ProgressOptions look;
  look.terminal = terminal;
  look.unicode = locale_is_unicode();
  look.last_step = lattice.steps;
  look.last_strain = lattice.shear_rate * double(lattice.steps);
  Progress progress(std::cout, look);
  ProgressState state;
  const Kokkos::Timer timer;
  const auto show = [&](std::int64_t steps_done) {
    state.step = steps_done;
    state.strain = lattice.shear_rate * double(steps_done);
    state.mlups = lattice.box_volume() * double(steps_done) / timer.seconds() / 1e6;
    progress.update(state);
  };

  RunEnd end;
  try {
    for (; end.steps < lattice.steps; ++end.steps) {
      const std::int64_t step = end.steps;
      if (interrupted) {
        end.stopped_by = "interrupt";
        end.code = exit_code::interrupted;
        break;
      }
      if (lattice.snapshot_every > 0 && step % lattice.snapshot_every == 0) outputs.snapshot(suspension);
      if (step % lattice.series_every == 0) {
        const Sample sample = suspension.step_and_measure();
        suspension.check();
        outputs.series(sample);
        series.add(sample);
        const auto viscosity = series.relative_viscosity();
        state.relative_viscosity = viscosity.mean;
        state.relative_viscosity_error = viscosity.error;
        state.volume_drift_max = sample.volume_drift_max;
        show(step + 1);
      } else {
        suspension.step();
        if (step % guard_every == 0) suspension.check();
        if (step % progress_every == 0) show(step + 1);
      }
    }
    if (end.steps == lattice.steps) {
      if (lattice.snapshot_every > 0) outputs.snapshot(suspension);
      // What a step measures is the state at its beginning: one more for the state at the end.
      const Sample sample = suspension.step_and_measure();
      suspension.check();
      outputs.series(sample);
      series.add(sample);
    } else if (lattice.snapshot_every > 0) {
      outputs.snapshot(suspension);
    }
  } catch (const SimulationError& broken) {
    end.stopped_by = "guard";
    end.failure = broken.what();
    end.code = exit_code::broken_run;
  } catch (const OutputError& failed) {  // the disk is full, the directory gone ...: end in order, keep what was flushed
    end.stopped_by = "output error";
    end.failure = failed.what() + std::string(".");
    end.code = exit_code::failure;
  }
  Kokkos::fence();
  end.seconds = timer.seconds();
  show(end.steps);
  progress.finish(end.stopped_by);
  return end;
}

std::string result_line(const Summary& s, const fs::path& directory) {
  std::string text = fmt::format("{} steps in {} ({:.1f} MLUPS)", s.steps, format_duration(s.wall_seconds), s.mlups);
  if (std::isfinite(s.relative_viscosity.mean)) {
    text += fmt::format("; relative viscosity {:.4f}", s.relative_viscosity.mean);
    if (std::isfinite(s.relative_viscosity.error)) text += fmt::format(" +- {:.4f}", s.relative_viscosity.error);
    if (s.cell_count > 0 && !s.converged) text += " (not converged: the averaged part is shorter than 20 correlation times)";
  }
  return text + fmt::format("; results in {}", directory.string());
}

}  // namespace

int run(const RunOptions& options) {
  const fs::path directory = options.output;
  const Problem problem = read_scene(options.scene, options.overrides);
  const LatticeParameters lattice = to_lattice(problem);
  check_output(directory, options.overwrite);
  print_warnings(lattice.warnings);
  const auto types = make_cell_types(problem, lattice);
  Packing packing = packing_layout(lattice);
  const bool packed_before = !problem.run.packing.empty();
  if (packed_before) packing = load_packing(problem.run.packing, packing);

  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on the size of files is an error of the write, not the end of the process
  const KokkosSession session(options.threads);
  const bool terminal = stream_is_terminal(stdout);
  try {
    if (!packed_before) packing.positions = pack(problem, lattice, types, terminal);
  } catch (const InputError&) {
    if (!interrupted) throw;
    std::cerr << "error: Stopped while packing; nothing was written." << std::endl;
    return exit_code::interrupted;
  }

  // Before anything old is removed: this is where memory runs out.
  const auto suspension = make_suspension(problem, lattice, types, packing.positions);
  std::error_code error;
  const bool existed = fs::exists(directory, error);
  fs::create_directories(directory, error);
  if (error) throw InputError(fmt::format("--output {} can't be created ({}); choose another place.", directory.string(), error.message()));
  std::optional<DirectoryLock> lock;
  std::optional<ReplacedResults> replaced;
  std::optional<Outputs> created;
  try {
    lock.emplace(directory);
    check_output(directory, options.overwrite, lock.has_value());  // another run may have come and gone while this one was packing
    replaced.emplace(directory, problem.run.packing);
    std::ofstream scene(directory / "scene.toml");
    if (!(scene << to_toml(problem) << std::flush)) throw OutputError((directory / "scene.toml").string() + " can't be written (is the disk full?)");
    if (!packed_before && !types.empty()) save_packing(directory / "packing.h5", packing);
    created.emplace(directory, problem, lattice, types);
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
  Outputs& outputs = *created;
  packing.positions = {};
  if (packs_cells(problem, types)) suspension->settle();
  SeriesSummary series(lattice, problem.run.discard);
  std::optional<Profile> profile;
  if (options.profile) profile.emplace();
  const RunEnd end = simulate(lattice, *suspension, outputs, series, terminal);

  Summary summary = series.result();
  summary.steps = end.steps;
  summary.strain = lattice.shear_rate * double(end.steps);
  summary.wall_seconds = end.seconds;
  summary.mlups = lattice.box_volume() * double(end.steps) / end.seconds / 1e6;
  summary.threads = Kokkos::DefaultExecutionSpace().concurrency();
  summary.bytes_peak = peak_memory_bytes();
  summary.stopped_by = end.stopped_by;
  summary.warnings = lattice.warnings;
  std::string failure = end.failure;
  int code = end.code;
  const auto attempt = [&](const auto& write) {  // each on its own: a small summary may fit where the series doesn't
    try {
      write();
    } catch (const OutputError& failed) {
      if (failure.empty()) failure = failed.what() + std::string(".");
      if (code == exit_code::success) code = exit_code::failure;
    }
  };
  attempt([&] { outputs.flush(); });
  if (profile) summary.profile = profile->times();
  attempt([&] { write_summary(directory / "summary.json", summary); });
  if (profile) std::cout << profile_table(summary.profile);
  std::cout << result_line(summary, directory) << std::endl;
  if (!failure.empty()) std::cerr << "error: " << failure << " " << what_is_kept(directory) << std::endl;
  return code;
}

}  // namespace corpuscle::app
