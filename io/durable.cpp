#include "io/durable.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "core/error.hpp"

namespace corpuscle {

void Hash::mix(std::uint64_t word) {
  // Each step is a bijection of the state for a given word and of the word for a given state: one changed word always changes the result.
  state_ = (std::rotl(state_, 23) ^ word) * 0xff51afd7ed558ccdULL;
  state_ ^= state_ >> 32;
}

void Hash::add(std::span<const unsigned char> bytes) {
  length_ += bytes.size();
  std::size_t i = 0;
  for (; i < bytes.size() && pending_bytes_ != 0; ++i) {
    pending_ |= std::uint64_t{bytes[i]} << (8 * pending_bytes_);
    if (++pending_bytes_ == 8) {
      mix(pending_);
      pending_ = 0;
      pending_bytes_ = 0;
    }
  }
  for (; i + 8 <= bytes.size(); i += 8) {
    std::uint64_t word;
    std::memcpy(&word, &bytes[i], 8);
    if constexpr (std::endian::native == std::endian::big) word = __builtin_bswap64(word);
    mix(word);
  }
  for (; i < bytes.size(); ++i) pending_ |= std::uint64_t{bytes[i]} << (8 * pending_bytes_++);
}

std::uint64_t Hash::value() const {
  Hash end = *this;
  end.mix(pending_);
  end.mix(length_);
  return end.state_;
}

int write_at(int file, std::uint64_t address, std::span<const unsigned char> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(file, bytes.data(), std::min<std::size_t>(bytes.size(), std::size_t{1} << 30), static_cast<off_t>(address));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return written < 0 ? errno : ENOSPC;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    address += static_cast<std::uint64_t>(written);
  }
  return 0;
}

int sync_file(int file) {
  while (::fsync(file) != 0) {
    if (errno == EINVAL || errno == ENOTSUP || errno == ENOSYS) return 0;
    if (errno != EINTR) return errno;
  }
  return 0;
}

void sync_directory(const std::filesystem::path& directory) {
  const int file = ::open(directory.empty() ? "." : directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  (void)sync_file(file);
  ::close(file);
}

void replace_file(const std::filesystem::path& path, std::string_view text, const std::string& what) {
  auto temporary = path;
  temporary += ".tmp";
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  int failed = file < 0 ? errno : write_at(file, 0, {reinterpret_cast<const unsigned char*>(text.data()), text.size()});
  if (failed == 0) failed = sync_file(file);
  if (file >= 0 && ::close(file) != 0 && failed == 0) failed = errno;
  std::error_code error = std::error_code(failed, std::generic_category());
  if (failed == 0) std::filesystem::rename(temporary, path, error);
  if (!error) {
    sync_directory(path.parent_path());
    return;
  }
  std::error_code ignored;
  std::filesystem::remove(temporary, ignored);
  throw OutputError(path.string() + ": writing " + what + " failed: " + error.message());
}

}  // namespace corpuscle
