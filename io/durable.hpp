// What survives a crash of the machine, and how one sees that a file is whole.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace corpuscle {

/// A running 64-bit hash of bytes, for files: finds every flipped bit, any cut, any swap. No protection against intent.
class Hash {
 public:
  /// Parts may be given in any division; only their sequence counts.
  void add(std::span<const unsigned char> bytes);
  std::uint64_t value() const;

 private:
  void mix(std::uint64_t word);
  std::uint64_t state_ = 0x9e3779b97f4a7c15ULL, length_ = 0, pending_ = 0;
  int pending_bytes_ = 0;
};

/// Writes all bytes at a place of a file. @returns 0 or errno.
int write_at(int file, std::uint64_t address, std::span<const unsigned char> bytes);
/// Waits until a file's data are on disk. @returns 0 or errno; what a file system cannot do is no error.
int sync_file(int file);
/// The same for the names in a directory (new, renamed, removed files).
void sync_directory(const std::filesystem::path& directory);
/// Writes a small text file as a whole: to a temporary name (`path`.tmp), to disk, then renamed, so that there always is the old one or the new one.
/// @throws OutputError "path: writing WHAT failed: reason"; the old file is then still there.
void replace_file(const std::filesystem::path& path, std::string_view text, const std::string& what);

}  // namespace corpuscle
