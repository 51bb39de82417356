// The directory of a sweep: sweep.json, scenes/NAME.toml, logs/NAME.log and the runs' own directories NAME/.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "app/sweep_plan.hpp"
#include "io/sweep_record.hpp"

namespace corpuscle::app {

class SweepDirectory {
 public:
  /// Compares the points with what is there and writes nothing. A point that is there keeps its name; its state is that of its directory.
  /// @throws InputError that lists points whose settings differ from those that a run of their name has begun with
  SweepDirectory(std::filesystem::path directory, const std::string& base_scene, std::vector<PlannedPoint>& points);

  /// Makes the folders, writes the scenes of runs that have not begun, and sweep.json. @throws InputError, OutputError
  void write();
  /// After a change of `record()`. @throws OutputError
  void write_record() const { write_sweep_record(directory_, record_); }

  const std::filesystem::path& path() const { return directory_; }
  std::filesystem::path run(const std::string& name) const { return directory_ / name; }
  std::filesystem::path scene(const std::string& name) const { return directory_ / "scenes" / (name + ".toml"); }
  std::filesystem::path log(const std::string& name) const { return directory_ / "logs" / (name + ".log"); }

  /// Runs that were there come first, in their old order.
  SweepRecord& record() { return record_; }
  const SweepRecord& record() const { return record_; }
  /// Which run each point is.
  std::size_t run_of(std::size_t point) const { return run_of_[point]; }
  /// Runs in the directory that the sweep has no point for any more.
  std::vector<std::string> left_over() const;
  /// Looks at a run's directory again. `steps`: its planned length.
  void refresh(std::size_t run, std::int64_t steps);

 private:
  std::filesystem::path directory_;
  std::vector<PlannedPoint>& points_;
  SweepRecord record_;
  std::vector<std::size_t> run_of_;
};

}  // namespace corpuscle::app
