// Are the files of a run whole, and do they agree? Reads them only; what was wrong is told with what can be done about it.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

namespace corpuscle {

struct OutputProblem {
  std::string file;    ///< name in the directory
  std::string what;
  std::string advice;  ///< what is still good, what to do
};

struct OutputCheck {
  bool is_output = false;               ///< the directory holds at least one file of a run
  std::vector<OutputProblem> problems;  ///< empty: all is well
  std::vector<std::string> notes;       ///< what a reader may want to know, but is no fault
  std::int64_t samples = 0;             ///< that are complete in run.h5
  std::int64_t last_step = -1;          ///< of those; -1: none
  std::int64_t snapshots = 0;           ///< that are complete in cells.vtkhdf or fluid.vtkhdf
  std::int64_t resumes_at = -1;         ///< step of the newest good checkpoint; -1: none
};

/// Checks every file of docs/outputs.md in `directory`: readable, all datasets of one length, time without gaps, no NaN but the documented
/// ones, the same cells throughout, files that agree with each other. Damage of any kind becomes a problem, not an exception.
/// `skip`: files not to touch. `reading` is called before each piece of a file is read, so that a caller knows where a crash happened:
/// the HDF5 library may die of damaged files.
OutputCheck check_output_files(const std::filesystem::path& directory, const std::set<std::string>& skip = {},
                               const std::function<void(const std::string& file)>& reading = {});

}  // namespace corpuscle
