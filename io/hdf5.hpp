// A thin owner of one HDF5 file: groups, attributes, datasets that grow by rows, and errors that name path and reason.
// No HDF5 type appears here, so that including this header doesn't need HDF5's include path.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace corpuscle::hdf5 {

class Transaction;

using Shape = std::vector<std::size_t>;

/// A dataset read into memory: row-major values and their shape.
template <class T>
struct Array {
  Shape shape;
  std::vector<T> values;
};

/// How a dataset that grows along its first dimension is laid out.
struct RowLayout {
  Shape row_shape{};          ///< shape of one row; empty: one number a row
  std::string unit{};         ///< attribute `unit`; empty: no attribute
  std::string description{};  ///< attribute `description`; empty: no attribute
  std::size_t chunk_rows = 0; ///< rows per chunk; 0: about 64 KiB a chunk, at most 1024 rows
};

/// An open HDF5 file. Object names are absolute ("/series/strain"); T is double, float, int64_t, int32_t or uint8_t.
/// Files are never locked, so that a run's output can be read while the run goes on.
/// Every function throws OutputError that names the file, what was done and the system's reason.
class File {
 public:
  /// Creates the file, replacing an older one.
  static File create(const std::filesystem::path& path);
  /// Opens an existing file for reading and appending, in a transaction (io/hdf5_transaction.hpp): what is done until `close` reaches the file wholly or,
  /// after an error, a kill or without `close`, not at all.
  static File open_for_append(const std::filesystem::path& path);
  static File open_for_reading(const std::filesystem::path& path);

  File(File&& other) noexcept;
  File& operator=(File&& other) noexcept;
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  /// Closes without throwing; call close() where a failed write must be noticed.
  ~File();

  /// Writes everything out and closes. A full disk shows up here at the latest.
  void close();
  const std::filesystem::path& path() const { return path_; }

  bool exists(const std::string& name) const;
  /// Creates a group and its missing parents.
  void create_group(const std::string& name);

  /// Attributes of a group or dataset ("/" is the file itself). An existing attribute is replaced.
  void set_attribute(const std::string& object, const std::string& name, const std::string& value);  ///< variable-length UTF-8
  void set_attribute(const std::string& object, const std::string& name, const char* value) { set_attribute(object, name, std::string(value)); }
  void set_attribute(const std::string& object, const std::string& name, double value);
  void set_attribute(const std::string& object, const std::string& name, std::int64_t value);
  void set_attribute(const std::string& object, const std::string& name, std::span<const double> values);
  void set_attribute(const std::string& object, const std::string& name, std::span<const std::int64_t> values);
  /// Fixed-length ASCII string, the only kind that VTK's reader takes for `Type`.
  void set_ascii_attribute(const std::string& object, const std::string& name, const std::string& value);
  std::string string_attribute(const std::string& object, const std::string& name) const;
  double number_attribute(const std::string& object, const std::string& name) const;
  std::vector<double> numbers_attribute(const std::string& object, const std::string& name) const;

  /// Writes a whole dataset of fixed shape.
  template <class T>
  void write(const std::string& name, std::span<const T> values, const Shape& shape);
  void write_strings(const std::string& name, const std::vector<std::string>& values);  ///< [n] variable-length UTF-8
  std::vector<std::string> read_strings(const std::string& name) const;

  /// Creates an empty dataset [0, row_shape...] that `append` extends.
  template <class T>
  void create_rows(const std::string& name, const RowLayout& layout);
  /// Appends values.size() / row size rows.
  template <class T>
  void append(const std::string& name, std::span<const T> values);
  /// Cuts a dataset to its first `rows` rows (or extends it by zeros).
  void set_row_count(const std::string& name, std::size_t rows);

  Shape shape(const std::string& name) const;
  template <class T>
  Array<T> read(const std::string& name) const;
  /// Rows [first, first + count) along the first dimension: large datasets in pieces.
  template <class T>
  Array<T> read_rows(const std::string& name, std::size_t first, std::size_t count) const;

 private:
  File(std::int64_t id, std::filesystem::path path);
  void set_numbers(const std::string& object, const std::string& name, std::int64_t type, const void* values, std::size_t count, bool scalar);
  void require_stored(const std::string& name, const Shape& shape, std::size_t element_bytes) const;
  void require_room(const std::string& name, double bytes) const;
  [[noreturn]] void fail(const std::string& doing) const;
  std::int64_t check(std::int64_t result, const std::string& doing) const;

  std::int64_t id_ = -1;
  std::filesystem::path path_;
  std::shared_ptr<Transaction> transaction_;  ///< of a file that is open for appending
};

}  // namespace corpuscle::hdf5
