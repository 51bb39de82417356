#include "io/checkpoint_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "io/checkpoint.hpp"

namespace corpuscle {
namespace {

/// What keeps a whole checkpoint from being resumed; empty: nothing.
std::string misfit(const Checkpoint& checkpoint, const RunFacts& run, bool with_series) {
  const SuspensionState& state = checkpoint.state;
  if (run.readable && !std::equal(run.nodes.begin(), run.nodes.end(), checkpoint.nodes.begin(), checkpoint.nodes.end()))
    return "its lattice differs from the box of run.h5";
  if (run.readable && static_cast<std::size_t>(run.vertices()) * 3 != state.positions.size())
    return fmt::format("it has {} vertices, the cells of run.h5 have {}", state.positions.size() / 3, run.vertices());
  const auto finite = [](const std::vector<double>& values) { return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); }); };
  if (!finite(state.positions) || !finite(state.velocities)) return "a position or velocity is not a finite number";
  if (run.readable && with_series) {
    const auto found = std::count_if(run.steps.begin(), run.steps.end(), [&](std::int64_t step) { return step < state.step; });
    const auto expected = written_before(state.step, run.series_every);
    if (found != expected) return fmt::format("run.h5 holds {} samples from before its step {}, but {} were written", found, state.step, expected);
  }
  return {};
}

}  // namespace

std::int64_t check_checkpoints(const std::filesystem::path& directory, const RunFacts& run, bool with_series, const std::set<std::string>& skip,
                               const std::function<void(const std::string& file)>& reading, std::vector<OutputProblem>& problems) {
  std::int64_t newest = -1;
  std::vector<OutputProblem> bad;
  for (const char* name : CheckpointStore::names) {
    std::error_code ignored;
    if (skip.contains(name) || !std::filesystem::exists(directory / name, ignored)) continue;
    if (reading) reading(name);
    try {
      const CheckpointFile file(directory / name);
      const std::string what = misfit(file.contents(), run, with_series);
      if (what.empty()) newest = std::max(newest, file.contents().state.step);
      else bad.push_back({name, what, ""});
    } catch (const std::exception& error) {
      std::string text = error.what();
      if (const std::string prefix = (directory / name).string() + ": "; text.starts_with(prefix)) text.erase(0, prefix.size());
      bad.push_back({name, text, ""});
    }
  }
  for (auto& problem : bad) {
    problem.advice = newest >= 0 ? fmt::format("remove it: corpuscle resume then goes on from the other one, at step {}", newest)
                                 : "the run can't go on from it; what is in the other files can be used";
    problems.push_back(problem);
  }
  return newest;
}

}  // namespace corpuscle
