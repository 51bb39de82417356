#include "app/output_directory.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <system_error>

#include "core/error.hpp"
#include "io/lock.hpp"

namespace corpuscle::app {

namespace fs = std::filesystem;

void require_writable(const fs::path& directory) {
  std::error_code error;
  fs::path existing = fs::absolute(directory);
  while (!existing.empty() && !fs::exists(existing, error)) existing = existing.parent_path();
  if (!fs::is_directory(existing, error))
    throw InputError(fmt::format("--output {}: {} is not a directory; choose another place.", directory.string(), existing.string()));
  if (access(existing.c_str(), W_OK | X_OK) != 0)
    throw InputError(fmt::format("--output {}: no permission to write in {}; choose another place.", directory.string(), existing.string()));
  require_unlocked(directory);
}

void create_output_directory(const fs::path& directory) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (error) throw InputError(fmt::format("--output {} can't be created ({}); choose another place.", directory.string(), error.message()));
}

}  // namespace corpuscle::app
