#include "io/lock.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <utility>

#include "core/error.hpp"

namespace corpuscle {
namespace {

constexpr const char* file_name = "lock";

std::string read_text(int file) {
  char text[256];
  const ssize_t size = ::pread(file, text, sizeof text, 0);
  std::string holder(text, size > 0 ? static_cast<std::size_t>(size) : 0);
  holder.erase(std::min(holder.find('\n'), holder.size()));
  for (char& c : holder)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return holder.empty() ? "another process" : holder;  // it may not have written its name yet
}

std::string this_process() {
  char host[256] = "";
  if (::gethostname(host, sizeof host - 1) != 0) std::strcpy(host, "unknown host");
  return fmt::format("process {} on {}, since {:%Y-%m-%d %H:%M:%S}", ::getpid(), host, fmt::localtime(std::time(nullptr)));
}

/// The file that is locked must still be the one that the path names: its last holder removes it.
bool is_at(int file, const std::filesystem::path& path) {
  struct stat opened {}, named {};
  return ::fstat(file, &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

[[noreturn]] void refuse(const std::filesystem::path& directory, const std::string& holder) {
  throw InputError(fmt::format("--output {}: another run is writing there ({}); choose another directory, or wait until that run has ended.",
      directory.string(), holder));
}

}  // namespace

DirectoryLock::DirectoryLock(const std::filesystem::path& directory) : path_(directory / file_name) {
  for (;;) {
    const int file = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (file < 0) throw OutputError(fmt::format("{}: creating the lock failed: {}", path_.string(), std::strerror(errno)));
    bool taken = false;
    for (int look = 0; look < 5; ++look) {  // somebody who only asks, as lock_holder() does, is gone at once
      taken = ::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
      if (!taken) break;
      ::usleep(20'000);
    }
    if (taken) {
      const std::string holder = read_text(file);
      ::close(file);
      refuse(directory, holder);
    }
    // Any other failure means that the file system has no locks: then two runs are not kept apart.
    if (!is_at(file, path_)) {
      ::close(file);
      continue;
    }
    file_ = file;
    break;
  }
  const std::string holder = this_process() + "\n";
  if (::ftruncate(file_, 0) != 0 || ::pwrite(file_, holder.data(), holder.size(), 0) < 0) {
    // A full disk: the lock holds without a name.
  }
}

DirectoryLock::DirectoryLock(DirectoryLock&& other) noexcept : path_(std::move(other.path_)), file_(std::exchange(other.file_, -1)) {}

DirectoryLock::~DirectoryLock() {
  if (file_ < 0) return;
  std::error_code ignored;
  if (is_at(file_, path_)) std::filesystem::remove(path_, ignored);  // while it is held: whoever waits looks again
  ::close(file_);
}

std::string lock_holder(const std::filesystem::path& directory) {
  const int file = ::open((directory / file_name).c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) return {};
  std::string holder;
  if (::flock(file, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK) holder = read_text(file);
  ::close(file);
  return holder;
}

void require_unlocked(const std::filesystem::path& directory) {
  const std::string holder = lock_holder(directory);
  if (!holder.empty()) refuse(directory, holder);
}

}  // namespace corpuscle
