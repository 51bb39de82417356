#include "io/hdf5_transaction.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <sys/stat.h>
#include <unistd.h>

#if H5_VERSION_GE(1, 13, 0)
#include <H5FDdevelop.h>
#endif

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <limits>
#include <span>

#include "core/error.hpp"
#include "io/durable.hpp"

namespace corpuscle::hdf5 {
namespace {

// The journal: this header, then for each change its address, its length and its bytes, then a hash of all before. Numbers as they lie in memory: a journal
// is read by the machine that wrote it, or by one that shares its disk.
constexpr std::array<char, 8> journal_mark{'c', 'o', 'r', 'p', 'j', 'n', 'l', '1'};
struct JournalHeader {
  std::array<char, 8> mark = journal_mark;
  std::uint64_t changes = 0;
  std::uint64_t size = 0;  ///< of the file after the commit
};

/// A file that is closed at the end of the scope.
struct OpenFile {
  int number;
  explicit OpenFile(int n) : number(n) {}
  ~OpenFile() {
    if (number >= 0) ::close(number);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
};

[[noreturn]] void fail_path(const std::filesystem::path& path, const char* doing, int error) {
  throw OutputError(fmt::format("{}: {} failed: {}", path.string(), doing, std::strerror(error)));
}

void append(std::vector<unsigned char>& to, const void* from, std::size_t bytes) {
  const std::size_t end = to.size();
  to.resize(end + bytes);
  std::memcpy(to.data() + end, from, bytes);
}

/// Reads what is there; what is behind the end of the file is zero.
void read_at(int file, std::uint64_t address, std::size_t size, unsigned char* to) {
  while (size > 0) {
    const ssize_t got = ::pread(file, to, std::min<std::size_t>(size, std::size_t{1} << 30), static_cast<off_t>(address));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    to += got;
    size -= static_cast<std::size_t>(got);
    address += static_cast<std::uint64_t>(got);
  }
  if (size > 0) std::memset(to, 0, size);  // an empty journal has no bytes to point to
}

std::uint64_t size_of(int file) {
  struct stat status{};
  return ::fstat(file, &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

/// Does what a journal says. May be done again, in part or as a whole. @returns 0 or errno.
int apply_journal(std::span<const unsigned char> journal, int file) {
  JournalHeader header;
  std::memcpy(&header, journal.data(), sizeof header);
  std::size_t at = sizeof header;
  for (std::uint64_t i = 0; i < header.changes; ++i) {
    std::array<std::uint64_t, 2> place{};
    std::memcpy(place.data(), &journal[at], sizeof place);
    at += sizeof place;
    if (const int error = write_at(file, place[0], journal.subspan(at, place[1])); error != 0) return error;
    at += place[1];
  }
  if (::ftruncate(file, static_cast<off_t>(header.size)) != 0) return errno;
  return sync_file(file);
}

/// Whether the changes fill a journal to its end, neither more nor less.
bool consistent(std::span<const unsigned char> content) {
  JournalHeader header;
  std::memcpy(&header, content.data(), sizeof header);
  std::size_t at = sizeof header;
  for (std::uint64_t i = 0; i < header.changes; ++i) {
    std::array<std::uint64_t, 2> place{};
    if (content.size() - at < sizeof place) return false;
    std::memcpy(place.data(), &content[at], sizeof place);
    at += sizeof place;
    if (content.size() - at < place[1]) return false;
    at += place[1];
  }
  return at == content.size();
}

/// Whether a journal was written to its end.
bool whole(std::span<const unsigned char> journal) {
  if (journal.size() < sizeof(JournalHeader) + sizeof(std::uint64_t)) return false;
  const auto content = journal.first(journal.size() - sizeof(std::uint64_t));
  std::uint64_t stored = 0;
  std::memcpy(&stored, &journal[content.size()], sizeof stored);
  Hash hash;
  hash.add(content);
  return hash.value() == stored && std::memcmp(journal.data(), journal_mark.data(), journal_mark.size()) == 0 && consistent(content);
}

}  // namespace

std::filesystem::path journal_path(const std::filesystem::path& path) {
  auto journal = path;
  journal += ".journal";
  return journal;
}

bool recover(const std::filesystem::path& path) {
  const auto journal = journal_path(path);
  const OpenFile notes(::open(journal.c_str(), O_RDONLY | O_CLOEXEC));
  if (notes.number < 0) return false;
  std::vector<unsigned char> bytes(size_of(notes.number));
  read_at(notes.number, 0, bytes.size(), bytes.data());
  const bool valid = whole(bytes);
  if (valid) {
    const OpenFile file(::open(path.c_str(), O_RDWR | O_CLOEXEC));
    if (file.number < 0) fail_path(path, "opening the file to finish what an interrupted run began to write", errno);
    if (const int error = apply_journal(bytes, file.number); error != 0) fail_path(path, "finishing what an interrupted run began to write", error);
  }
  ::unlink(journal.c_str());
  return valid;
}

Transaction::~Transaction() {
  if (begun_ && !done_) (void)!::ftruncate(file_, static_cast<off_t>(old_end_));
  ::close(file_);
}

void Transaction::begin(std::uint64_t end) {
  begun_ = true;
  old_end_ = std::min(end, size_of(file_));
}

void Transaction::fail(int error) {
  if (error_ == 0) error_ = error;
}

void Transaction::read(std::uint64_t address, std::size_t size, unsigned char* to) const {
  read_at(file_, address, size, to);
  for (auto change = changed_.lower_bound(address / page); change != changed_.end() && change->first * page < address + size; ++change) {
    const std::uint64_t first = change->first * page;
    const std::uint64_t from = std::max(first, address), until = std::min(first + change->second.size(), address + size);
    if (from < until) std::memcpy(to + (from - address), &change->second[from - first], until - from);
  }
}

void Transaction::write(std::uint64_t address, std::size_t size, const unsigned char* from) {
  size_ = std::max(size_, address + size);
  while (size > 0 && address < old_end_) {
    const std::uint64_t number = address / page, first = number * page;
    auto& bytes = changed_[number];
    if (bytes.empty()) {
      bytes.resize(std::min(page, old_end_ - first));
      read_at(file_, first, bytes.size(), bytes.data());
    }
    const std::size_t n = std::min<std::size_t>(size, first + bytes.size() - address);
    std::memcpy(&bytes[address - first], from, n);
    address += n;
    from += n;
    size -= n;
  }
  if (size > 0 && error_ == 0)
    if (const int error = write_at(file_, address, {from, size}); error != 0) fail(error);
}

std::vector<unsigned char> Transaction::journal() const {
  JournalHeader header;
  header.changes = changed_.size();
  header.size = size_;
  std::vector<unsigned char> journal;
  journal.reserve(sizeof header + changed_.size() * (page + 16) + 8);
  append(journal, &header, sizeof header);
  for (const auto& [number, bytes] : changed_) {
    const std::array<std::uint64_t, 2> place{number * page, bytes.size()};
    append(journal, place.data(), sizeof place);
    append(journal, bytes.data(), bytes.size());
  }
  Hash hash;
  hash.add(journal);
  const std::uint64_t value = hash.value();
  append(journal, &value, sizeof value);
  return journal;
}

void Transaction::commit(const std::filesystem::path& path) {
  if (error_ == 0) fail(sync_file(file_));
  if (error_ != 0) fail_path(path, "writing to disk", error_);
  const auto bytes = journal();
  const auto name = journal_path(path);
  {
    const OpenFile notes(::open(name.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
    int error = notes.number < 0 ? errno : write_at(notes.number, 0, bytes);
    if (error == 0) error = sync_file(notes.number);
    if (error != 0) {
      ::unlink(name.c_str());
      fail_path(path, "writing to disk", error);
    }
  }
  sync_directory(name.parent_path());
  done_ = true;  // from here on the new state counts, even if what follows fails
  if (const int error = apply_journal(bytes, file_); error != 0) fail_path(path, "writing to disk", error);
  ::unlink(name.c_str());
}

// The file driver through which HDF5 reads and writes: HDF5 File Driver interface (H5FDpublic.h), the functions that a driver must have.
namespace {

struct DriverFile {
  H5FD_t base;  // HDF5 keeps its own data here
  std::shared_ptr<Transaction> transaction;
};

DriverFile& of(const H5FD_t* file) { return *reinterpret_cast<DriverFile*>(const_cast<H5FD_t*>(file)); }

H5FD_t* driver_open(const char* name, unsigned, hid_t, haddr_t) {
  const int file = ::open(name, O_RDWR | O_CLOEXEC);
  if (file < 0) {
    // In the form in which HDF5's own drivers tell the system's reason.
    H5Epush2(H5E_DEFAULT, __FILE__, __func__, __LINE__, H5E_ERR_CLS, H5E_FILE, H5E_CANTOPENFILE,
             "unable to open file: error message = '%s'", std::strerror(errno));
    return nullptr;
  }
  auto* opened = new DriverFile{H5FD_t{}, std::make_shared<Transaction>(file)};
  opened->transaction->write(size_of(file), 0, nullptr);  // its size
  return &opened->base;
}

herr_t driver_close(H5FD_t* file) {
  delete &of(file);
  return 0;
}

int driver_compare(const H5FD_t* a, const H5FD_t* b) { return a < b ? -1 : a > b; }

herr_t driver_query(const H5FD_t*, unsigned long* flags) {
  if (flags != nullptr) *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE | H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

haddr_t driver_allocated(const H5FD_t* file, H5FD_mem_t) { return of(file).transaction->allocated; }

herr_t driver_allocate(H5FD_t* file, H5FD_mem_t, haddr_t end) {
  of(file).transaction->allocated = end;
  return 0;
}

haddr_t driver_size(const H5FD_t* file, H5FD_mem_t) { return of(file).transaction->size(); }

herr_t driver_handle(H5FD_t* file, hid_t, void** handle) {
  *handle = &of(file).transaction;
  return 0;
}

herr_t driver_read(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, size_t size, void* to) {
  of(file).transaction->read(address, size, static_cast<unsigned char*>(to));
  return 0;
}

herr_t driver_write(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, size_t size, const void* from) {
  of(file).transaction->write(address, size, static_cast<const unsigned char*>(from));
  return 0;
}

herr_t driver_truncate(H5FD_t* file, hid_t, hbool_t) {
  of(file).transaction->truncate();
  return 0;
}

hid_t driver() {
  static const hid_t registered = [] {
    H5FD_class_t c{};
#if H5_VERSION_GE(1, 13, 2)
    c.version = H5FD_CLASS_VERSION;
    c.value = static_cast<H5FD_class_value_t>(H5_VFD_RESERVED + 67);
#endif
    c.name = "corpuscle_transaction";
    c.maxaddr = static_cast<haddr_t>(std::numeric_limits<off_t>::max());
    c.fc_degree = H5F_CLOSE_STRONG;
    c.open = driver_open;
    c.close = driver_close;
    c.cmp = driver_compare;
    c.query = driver_query;
    c.get_eoa = driver_allocated;
    c.set_eoa = driver_allocate;
    c.get_eof = driver_size;
    c.get_handle = driver_handle;
    c.read = driver_read;
    c.write = driver_write;
    c.truncate = driver_truncate;
    const H5FD_mem_t kinds[] = H5FD_FLMAP_DICHOTOMY;
    std::copy(std::begin(kinds), std::end(kinds), std::begin(c.fl_map));
    return H5FDregister(&c);
  }();
  return registered;
}

}  // namespace

void use_transactions(std::int64_t file_access) { H5Pset_driver(file_access, driver(), nullptr); }

std::shared_ptr<Transaction> transaction_of(std::int64_t file) {
  void* handle = nullptr;
  if (H5Fget_vfd_handle(file, H5P_DEFAULT, &handle) < 0 || handle == nullptr) return nullptr;
  return *static_cast<std::shared_ptr<Transaction>*>(handle);
}

}  // namespace corpuscle::hdf5
