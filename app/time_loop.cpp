#include "app/time_loop.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include <Kokkos_Profiling_ScopedRegion.hpp>

#include "app/machine.hpp"
#include "app/profile.hpp"
#include "core/error.hpp"
#include "core/version.hpp"
#include "io/analysis_file.hpp"
#include "io/durable.hpp"
#include "io/output_kept.hpp"
#include "io/progress.hpp"
#include "io/scene.hpp"
#include "physics/analysis/live.hpp"

namespace corpuscle::app {

Checkpoints::Checkpoints(const std::filesystem::path& directory, const Problem& problem, const LatticeParameters& lattice)
    : store_(directory), every_(60 * problem.output.checkpoint_every), every_steps_(lattice.next_coupling(problem.output.checkpoint_steps.value_or(0))),
      every_strain_(lattice.checkpoint_every) {
  contents_.scene = to_toml(problem);
  contents_.version = version_string();
  contents_.git_revision = git_revision();
  contents_.lattice = lattice_numbers(lattice);
  contents_.nodes = lattice.nodes;
}

void Checkpoints::go_on_after(const CheckpointFile& file) {
  store_.go_on_after(file);
  last_step_ = file.contents().state.step;
}

bool Checkpoints::due(std::int64_t step) const {
  if (step == last_step_) return false;
  for (const auto every : {every_steps_, every_strain_})
    if (every > 0 && step % every == 0) return true;
  return every_.count() > 0 && Clock::now() - last_ >= every_;
}

void Checkpoints::write(Suspension& suspension, Outputs& outputs, const SeriesSummary& series, const std::optional<LiveStatistics>& statistics, std::int64_t step, double seconds) {
  if (step == last_step_) return;
  const Kokkos::Profiling::ScopedRegion region("write_checkpoint");
  const auto begin = Clock::now();
  suspension.check();
  outputs.flush();
  contents_.state = suspension.state();
  contents_.summary = series.save();
  if (statistics) contents_.statistics = statistics->save();
  contents_.seconds = seconds;
  store_.write(contents_, [&](int direction) { return suspension.population(direction); });
  contents_.state = {};
  contents_.statistics = {};
  last_step_ = step;
  last_ = Clock::now();
  seconds_to_write_ = std::chrono::duration<double>(last_ - begin).count();
}

std::optional<LiveStatistics> live_statistics(const Problem& problem, const LatticeParameters& lattice) {
  if (!problem.output.statistics) return {};
  return LiveStatistics(lattice, problem.box.walls, problem.run.discard);
}

namespace {

void write_statistics(const ReadyRun& run) {
  if (!run.statistics || run.statistics->samples() == 0) return;
  const auto [record, found] = analysis::live_analysis(*run.statistics, run.lattice);
  replace_file(run.directory / "statistics.json", analysis_json(record, found).dump(1) + "\n", "the statistics");
}

/// How the time loop ended.
struct RunEnd {
  std::int64_t steps = 0;
  double seconds = 0;   ///< of this process
  int code = exit_code::success;
  std::string stopped_by = "end";
  std::string failure;  ///< message for the user; empty when all went well
};

/// The line that tells how far the run is.
class ProgressLine {
 public:
  explicit ProgressLine(const ReadyRun& run) : run_(run), progress_(std::cout, options(run)) {}
  void show(std::int64_t steps_done) {
    state_.step = steps_done;
    state_.strain = run_.lattice.shear_rate * double(steps_done);
    state_.mlups = run_.lattice.box_volume() * double(steps_done - run_.first_step) / timer_.seconds() / 1e6;
    progress_.update(state_);
  }
  void show(std::int64_t steps_done, const Sample& sample) {
    const auto viscosity = run_.series.relative_viscosity();
    state_.relative_viscosity = viscosity.mean;
    state_.relative_viscosity_error = viscosity.error;
    state_.volume_drift_max = sample.volume_drift_max;
    show(steps_done);
  }
  void finish(const std::string& reason) { progress_.finish(reason); }

 private:
  static ProgressOptions options(const ReadyRun& run) {
    ProgressOptions look;
    look.terminal = stream_is_terminal(stdout);
    look.unicode = locale_is_unicode();
    look.first_step = run.first_step;
    look.last_step = run.lattice.steps;
    look.last_strain = run.lattice.shear_rate * double(run.lattice.steps);
    return look;
  }
  const ReadyRun& run_;
  Progress progress_;
  ProgressState state_;
  Kokkos::Timer timer_;
};

Stop stop_asked(const ReadyRun& run) {
  if (const Stop signal = signal_received(); signal != Stop::none) return signal;
  return run.wall_time.over(run.checkpoints.seconds_to_write()) ? Stop::wall_time : Stop::none;
}

RunEnd simulate(const ReadyRun& run) {
  const LatticeParameters& lattice = run.lattice;
  const std::int64_t progress_every = lattice.next_coupling(32);
  ProgressLine line(run);
  const Kokkos::Timer timer;
  const auto sample_now = [&] {
    const Sample sample = run.suspension.step_and_measure();
    run.suspension.check();
    run.outputs.series(sample);
    run.series.add(sample);
    if (run.statistics) run.statistics->add(sample);
    return sample;
  };
  RunEnd end;
  end.steps = run.first_step;
  const auto checkpoint = [&] {
    run.checkpoints.write(run.suspension, run.outputs, run.series, run.statistics, end.steps, run.earlier_seconds + timer.seconds());
  };
  Stop stop = Stop::none;
  try {
    if (run.first_step == 0) checkpoint();  // unless the start is broken, there is one
    for (; end.steps < lattice.steps; end.steps += lattice.coupling_every) {
      const std::int64_t step = end.steps;
      stop = stop_asked(run);
      if (stop != Stop::none) break;
      if (run.checkpoints.due(step)) {
        checkpoint();
        write_statistics(run);
      }
      if (lattice.snapshot_every > 0 && step % lattice.snapshot_every == 0) run.outputs.snapshot(run.suspension);
      if (step % lattice.series_every == 0) {
        const Sample sample = sample_now();
        line.show(step + lattice.coupling_every, sample);
      } else {
        run.suspension.step();
        if (step % lattice.guard_every == 0) run.suspension.check();
        if (step % progress_every == 0) line.show(step + lattice.coupling_every);
      }
    }
    if (stop != Stop::none) {
      end.stopped_by = name_of(stop);
      end.code = exit_code_of(stop);
    }
    checkpoint();  // before what is written at the end only: a run that is extended goes on without it
    if (lattice.snapshot_every > 0) run.outputs.snapshot(run.suspension);
    // What a step measures is the state at its beginning: one more for the state at the end.
    if (stop == Stop::none) sample_now();
  } catch (const SimulationError& broken) {
    end.stopped_by = "guard";
    end.failure = broken.what() + run.outputs.broken_state(run.suspension);
    end.code = exit_code::broken_run;
  } catch (const OutputError& failed) {  // the disk is full, the directory gone ...: end in order, keep what was flushed
    end.stopped_by = "output error";
    end.failure = failed.what() + std::string(".");
    end.code = exit_code::failure;
  }
  Kokkos::fence();
  end.seconds = timer.seconds();
  line.show(end.steps);
  line.finish(end.stopped_by);
  return end;
}

std::string result_line(const Summary& s, const std::filesystem::path& directory) {
  std::string text = fmt::format("{} steps in {} ({:.1f} MLUPS)", s.steps, format_duration(s.wall_seconds), s.mlups);
  if (std::isfinite(s.relative_viscosity.mean)) {
    text += fmt::format("; relative viscosity {:.4f}", s.relative_viscosity.mean);
    if (std::isfinite(s.relative_viscosity.error)) text += fmt::format(" +- {:.4f}", s.relative_viscosity.error);
    if (s.cell_count > 0 && !s.converged) text += " (not converged: the averaged part is shorter than 20 correlation times)";
  }
  if (const ResolutionError& e = s.viscosity_resolution_error; e.known()) text += fmt::format("; the resolution makes it {:+.0f} +- {:.0f} % off", 100 * e.value, 100 * e.uncertainty);
  return text + fmt::format("; results in {}", directory.string());
}

}  // namespace

int run_to_end(const ReadyRun& run) {
  std::optional<Profile> profile;
  if (run.profile) profile.emplace();
  const RunEnd end = simulate(run);

  Summary summary = run.series.result();
  summary.steps = end.steps;
  summary.strain = run.lattice.shear_rate * double(end.steps);
  summary.wall_seconds = run.earlier_seconds + end.seconds;
  summary.mlups = run.lattice.box_volume() * double(end.steps) / summary.wall_seconds / 1e6;
  summary.threads = Kokkos::DefaultExecutionSpace().concurrency();
  summary.bytes_peak = peak_memory_bytes();
  summary.stopped_by = end.stopped_by;
  summary.warnings = run.lattice.warnings;
  summary.viscosity_resolution_error = viscosity_resolution_error(run.problem, run.lattice);
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
  attempt([&] { run.outputs.flush(); });
  attempt([&] { write_statistics(run); });
  if (profile) summary.profile = profile->times();
  attempt([&] { write_summary(run.directory / "summary.json", summary); });
  if (profile) std::cout << profile_table(summary.profile);
  std::cout << result_line(summary, run.directory) << std::endl;
  if (code == exit_code::to_be_continued || code == exit_code::interrupted || code == exit_code::failure)
    std::cout << fmt::format("stopped by {}; corpuscle resume {} goes on", end.stopped_by, run.directory.string()) << std::endl;
  if (!failure.empty()) std::cerr << "error: " << failure << " " << what_is_kept(run.directory) << std::endl;
  return code;
}

}  // namespace corpuscle::app
