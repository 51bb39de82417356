// Two runs must not write into one directory: the first holds a lock on it.
#pragma once
#include <filesystem>
#include <string>

namespace corpuscle {

/// An exclusive lock on the file `lock` in a directory of results (flock(2)). The kernel releases it when the process ends, however that
/// happens, so a killed run leaves no lock behind, at most the file. The file names the holder: process, host, when it began.
class DirectoryLock {
 public:
  /// Takes the lock of a directory that exists. Where the file system has no locks, none is taken.
  /// @throws InputError that names the other run when it is taken; OutputError when the file can't be created.
  explicit DirectoryLock(const std::filesystem::path& directory);
  DirectoryLock(DirectoryLock&& other) noexcept;
  DirectoryLock& operator=(DirectoryLock&&) = delete;
  /// Removes the file and releases the lock.
  ~DirectoryLock();

 private:
  std::filesystem::path path_;
  int file_ = -1;
};

/// Who holds the lock of a directory ("process 4711 on node12, since 2024-06-11 10:20:30"); empty when nobody does. Changes nothing.
std::string lock_holder(const std::filesystem::path& directory);

/// @throws InputError when a run holds the lock of `directory`.
void require_unlocked(const std::filesystem::path& directory);

}  // namespace corpuscle
