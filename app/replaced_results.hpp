// What --overwrite replaces stays until the new results have begun: a disk that is full must not cost the old ones as well.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace corpuscle::app {

/// Whether a run writes a file of this name (docs/outputs.md); pictures and notes of the user are none.
bool is_result(const std::string& name);

/// Sets the results of an earlier run in a directory aside, into its folder `.replaced`.
class ReplacedResults {
 public:
  /// Moves every result file away, except the packing that the new run starts from. @throws OutputError.
  ReplacedResults(const std::filesystem::path& directory, const std::filesystem::path& packing_in_use);
  void restore();  ///< the new run could not begin: puts them back
  void discard();  ///< the new run has begun: removes them

 private:
  std::filesystem::path directory_, aside_;
  std::vector<std::filesystem::path> names_;
};

}  // namespace corpuscle::app
