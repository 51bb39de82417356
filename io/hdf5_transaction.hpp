// All or nothing for HDF5 files that grow: what is done between opening and closing a file reaches it wholly or not at all, whenever the process is killed.
// HDF5 itself overwrites its tables in place, one write after the other; a kill between two of them can make the whole file unreadable.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace corpuscle::hdf5 {

/// What HDF5 writes into one open file. Bytes behind the old end go straight to the file, where nothing refers to them yet; bytes that would overwrite old
/// ones wait in memory. `commit` writes those to a journal beside the file first (FILE.journal, with a checksum) and then in place: a kill before the journal
/// is whole leaves the old state, one after it leaves a journal that `recover` applies. Who opens the file before or after the last step
/// sees the old or the new state; who has it open during that step may see parts of both, as HDF5 reads its tables when it needs them. No write fails towards
/// HDF5, which cannot close a file after a failed write: the first failure is kept and thrown by `commit`, and the file stays as it was.
class Transaction {
 public:
  explicit Transaction(int file) : file_(file) {}
  /// Without `commit`: gives back the old state.
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  /// From here on bytes behind the end of what HDF5 knows (which may be less than the file's size, after a kill) are taken as new.
  void begin(std::uint64_t end);
  /// @throws OutputError with the path and the system's reason; the old state is kept.
  void commit(const std::filesystem::path& path);

  void read(std::uint64_t address, std::size_t size, unsigned char* to) const;
  void write(std::uint64_t address, std::size_t size, const unsigned char* from);

  // What HDF5 asks a file driver for.
  std::uint64_t allocated = 0;  ///< end of what HDF5 has allocated
  std::uint64_t size() const { return size_; }
  void truncate() { size_ = allocated; }

 private:
  struct Change {
    std::uint64_t address;
    std::vector<unsigned char> bytes;
  };
  std::vector<unsigned char> journal() const;
  void fail(int error);

  static constexpr std::uint64_t page = 4096;
  int file_;
  int error_ = 0;                ///< errno of the first failure
  bool begun_ = false, done_ = false;
  std::uint64_t old_end_ = ~std::uint64_t{0};
  std::uint64_t size_ = 0;       ///< of the file after the commit
  std::map<std::uint64_t, std::vector<unsigned char>> changed_;  ///< pages below the old end, by number
};

/// Makes a file access property list open files in a transaction; `transaction_of` gives the one of an open file.
void use_transactions(std::int64_t file_access);
std::shared_ptr<Transaction> transaction_of(std::int64_t file);

/// Finishes or removes what a process that was killed while it changed the file has left. Opening a file for appending does this too; for files that are only
/// read.
/// @returns whether the file was changed. @throws OutputError when the file can't be written.
bool recover(const std::filesystem::path& path);
/// Where the journal of a file lies.
std::filesystem::path journal_path(const std::filesystem::path& path);

}  // namespace corpuscle::hdf5
