#include "io/text_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "core/error.hpp"

namespace corpuscle {

void write_text_file(const std::filesystem::path& path, const std::string& text, const std::string& what) {
  auto temporary = path;
  temporary += ".tmp";
  const auto fail = [&](const std::string& reason) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw OutputError(fmt::format("{}: writing {} failed: {}", path.string(), what, reason));
  };
  errno = 0;
  std::ofstream file(temporary);
  file << text;
  file.close();
  if (!file) fail(errno != 0 ? std::strerror(errno) : "unknown reason");
  std::error_code error;
  std::filesystem::rename(temporary, path, error);
  if (error) fail(error.message());
}

}  // namespace corpuscle
