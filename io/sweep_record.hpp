// sweep.json: the runs of a sweep and how each of them stands. Whoever reads the results of a sweep starts here.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/sweep.hpp"

namespace corpuscle {

enum class RunState { waiting, running, finished, failed, stopped };
const char* name_of(RunState state);

struct SweepRun {
  std::string name;                 ///< of the point, and of its directory in that of the sweep
  std::vector<Override> overrides;  ///< of the base scene
  RunState state = RunState::waiting;
  std::optional<int> exit_code;     ///< of the last process; none while it waits or runs
  std::string message;              ///< why it failed
};

struct SweepRecord {
  std::string scene;  ///< path of the base scene
  std::vector<SweepRun> runs;
};

/// Nothing when the directory has no sweep.json. @throws InputError when that file is something else.
std::optional<SweepRecord> read_sweep_record(const std::filesystem::path& directory);
/// Replaces sweep.json as a whole. @throws OutputError
void write_sweep_record(const std::filesystem::path& directory, const SweepRecord& record);

/// What the directory of a run tells of it, whoever started it.
struct RunCondition {
  std::string writer;      ///< the process that writes there now; empty: none
  bool has_checkpoint = false;
  std::string stopped_by;  ///< of summary.json: "end", "guard", "interrupt" ...; empty: there is none
  std::int64_t steps = 0;  ///< of summary.json
};
RunCondition look_at_run(const std::filesystem::path& directory);

/// Brings a record up to date with what is found. `steps`: planned length of the run.
/// A run that a guard stopped has failed for good: it would come to the same end. Other failures are tried again.
void update(SweepRun& run, const RunCondition& found, std::int64_t steps);

}  // namespace corpuscle
