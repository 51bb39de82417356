#include "app/replaced_results.hpp"

#include <string>
#include <system_error>

#include "core/error.hpp"
#include "io/checkpoint.hpp"

namespace corpuscle::app {
namespace fs = std::filesystem;

bool is_result(const std::string& name) {
  for (const std::string known : {"run.h5", "summary.json", "statistics.json", "scene.toml", "packing.h5", "cells.vtkhdf", "fluid.vtkhdf", "broken.vtkhdf", "broken_fluid.vtkhdf",
                                  "analysis.json", "analysis.md"})
    if (name == known || name == known + ".journal" || name == known + ".tmp") return true;
  return name.starts_with("checkpoint-") || name == CheckpointStore::temporary_name;
}

ReplacedResults::ReplacedResults(const fs::path& directory, const fs::path& packing_in_use) : directory_(directory), aside_(directory / ".replaced") {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(directory, error)) {
    std::error_code differs;
    if (!is_result(entry.path().filename().string()) || (!packing_in_use.empty() && fs::equivalent(entry.path(), packing_in_use, differs))) continue;
    names_.push_back(entry.path().filename());
  }
  if (!error && !names_.empty()) fs::create_directories(aside_, error);
  for (const auto& name : names_)
    if (!error) fs::rename(directory_ / name, aside_ / name, error);
  if (!error) return;
  restore();
  throw OutputError(directory_.string() + ": setting the results of the earlier run aside failed: " + error.message());
}

void ReplacedResults::restore() {
  std::error_code ignored;
  for (const auto& name : names_) fs::rename(aside_ / name, directory_ / name, ignored);
  fs::remove(aside_, ignored);
}

void ReplacedResults::discard() {
  std::error_code ignored;
  for (const auto& name : names_) fs::remove(aside_ / name, ignored);
  fs::remove(aside_, ignored);
}

}  // namespace corpuscle::app
