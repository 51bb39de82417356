#include "app/sweep_execute.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <set>

#include "app/child_runs.hpp"
#include "core/error.hpp"
#include "io/lock.hpp"
#include "io/progress.hpp"

namespace corpuscle::app {
namespace {

/// A run that is given less than this would hardly get beyond its start.
constexpr double shortest_wall_time = 3;

std::string clock_text(double seconds) {
  const auto whole = static_cast<std::int64_t>(seconds);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

class Execution {
 public:
  Execution(SweepDirectory& directory, const std::vector<PlannedPoint>& points, const SweepWork& work, const WallTime& wall_time)
      : directory_(directory), points_(points), work_(work), wall_time_(wall_time), waiting_(longest_first(work.sizes)), total_(work.points.size()) {}

  int run() {
    listen_to_signals();
    Stop stop = Stop::none;
    Timer asked(1), looked(1);
    while (!waiting_.empty() || !children_.running().empty()) {
      const bool changed = collect();
      if (stop == Stop::none) {
        stop = signal_received();
        if (stop == Stop::none && wall_time_.over(shortest_wall_time)) stop = Stop::wall_time;
        if (stop != Stop::none && !children_.running().empty())
          tell(fmt::format("stopping ({}): {} runs write their checkpoints", name_of(stop), children_.running().size()));
      }
      if (stop != Stop::none) {
        if (children_.running().empty()) break;
        // Again and again: one that has just been started may miss the first. By the wall time they stop themselves.
        if (stop != Stop::wall_time && asked.due()) children_.signal(stop == Stop::user_signal ? SIGUSR1 : SIGTERM);
      } else if (changed || looked.due()) {
        while (start_next()) {
        }
      }
      ::usleep(20'000);
    }
    return finish(stop);
  }

 private:
  /// Due at once, then each so many seconds.
  class Timer {
   public:
    explicit Timer(double seconds) : every_(seconds) {}
    bool due() {
      const auto now = Clock::now();
      if (now < next_) return false;
      next_ = now + std::chrono::duration_cast<Clock::duration>(every_);
      return true;
    }

   private:
    using Clock = std::chrono::steady_clock;
    std::chrono::duration<double> every_;
    Clock::time_point next_;
  };

  SweepRun& run_at(std::size_t i) { return directory_.record().runs[directory_.run_of(work_.points[i])]; }
  void tell(const std::string& line) const { std::cout << line << std::endl; }

  /// @returns whether it has taken one from those that wait
  bool start_next() {
    std::vector<std::size_t> free;
    for (const std::size_t i : waiting_)
      if (!is_elsewhere(i)) free.push_back(i);
    const auto next = work_.slots.next(free, children_.running());
    if (!next) return false;
    std::erase(waiting_, *next);
    SweepRun& run = run_at(*next);
    directory_.refresh(directory_.run_of(work_.points[*next]), points_[work_.points[*next]].lattice.steps);
    if (run.state == RunState::finished || run.exit_code == exit_code::broken_run) {  // by another process, meanwhile
      ++done_;
      directory_.write_record();
      return true;
    }
    const ChildCommand command = command_for(*next, run);
    run.state = RunState::running;
    run.exit_code.reset();
    run.message.clear();
    directory_.write_record();  // before it begins: whatever is in its directory afterwards is known to be its own
    children_.start(*next, command);
    tell(fmt::format("{} {} ({} thread{})", command.arguments[0] == "run" ? "starting" : "resuming", run.name, command.threads, command.threads == 1 ? "" : "s"));
    return true;
  }

  /// Whether another process writes there, such as a run that outlived the sweep which started it.
  bool is_elsewhere(std::size_t i) {
    const std::string& name = run_at(i).name;
    const std::string holder = lock_holder(directory_.run(name));
    if (!holder.empty() && told_.insert(name).second) tell(fmt::format("{} is being run by {}; waiting for it", name, holder));
    return !holder.empty();
  }

  ChildCommand command_for(std::size_t i, const SweepRun& run) const {
    ChildCommand command;
    command.threads = work_.slots.threads(i);
    command.alone = work_.slots.at_once() == 1;
    command.log = directory_.log(run.name);
    const std::string output = directory_.run(run.name).string();
    if (look_at_run(output).has_checkpoint) command.arguments = {"resume", output};
    else {
      command.arguments = {"run", directory_.scene(run.name).string(), "--output", output};
      // It has begun once, and what it left is no use; but a run that was refused must not replace what it was refused for.
      const bool began = run.state == RunState::stopped || (run.state == RunState::failed && run.exit_code != exit_code::bad_input);
      if (began) command.arguments.emplace_back("--overwrite");
    }
    command.arguments.insert(command.arguments.end(), {"--threads", std::to_string(command.threads)});
    if (std::isfinite(wall_time_.left())) command.arguments.insert(command.arguments.end(), {"--wall-time", clock_text(std::max(1.0, wall_time_.left() - 1))});
    return command;
  }

  bool collect() {
    const auto ends = children_.ended();
    for (const ChildEnd& end : ends) {
      SweepRun& run = run_at(end.run);
      run.exit_code = end.code;
      run.message.clear();
      const bool killed_by_us = signal_received() != Stop::none && (end.code == 128 + SIGTERM || end.code == 128 + SIGUSR1 || end.code == 128 + SIGINT);
      if (end.code == exit_code::success) run.state = RunState::finished;
      else if (end.code == exit_code::to_be_continued || end.code == exit_code::interrupted || killed_by_us) run.state = RunState::stopped;
      else {
        run.state = RunState::failed;
        run.message = end.message.empty() ? fmt::format("exit code {}, see {}", end.code, directory_.log(run.name).string()) : end.message;
      }
      ++done_;
      tell(fmt::format("{} {}; {} of {} done{}", name_of(run.state), run.name, done_, total_, run.message.empty() ? "" : ": " + run.message));
      directory_.write_record();
    }
    return !ends.empty();
  }

  int finish(Stop stop) {
    std::size_t failed = 0, left = 0;
    for (std::size_t point = 0; point < points_.size(); ++point) {
      const SweepRun& run = directory_.record().runs[directory_.run_of(point)];
      failed += run.state == RunState::failed;
      left += run.state != RunState::failed && run.state != RunState::finished;
    }
    tell(fmt::format("{} finished, {} failed, {} left; results in {}", points_.size() - failed - left, failed, left, directory_.path().string()));
    if (left > 0) {
      tell("the same command goes on");
      return stop == Stop::interrupt ? exit_code::interrupted : exit_code::to_be_continued;
    }
    return failed > 0 ? exit_code::failure : exit_code::success;
  }

  SweepDirectory& directory_;
  const std::vector<PlannedPoint>& points_;
  const SweepWork& work_;
  const WallTime& wall_time_;
  std::vector<std::size_t> waiting_;
  std::size_t total_, done_ = 0;
  std::set<std::string> told_;
  ChildRuns children_;
};

}  // namespace

int execute(SweepDirectory& directory, const std::vector<PlannedPoint>& points, const SweepWork& work, const WallTime& wall_time) {
  return Execution(directory, points, work, wall_time).run();
}

}  // namespace corpuscle::app
