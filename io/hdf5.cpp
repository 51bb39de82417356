#include "io/hdf5.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "core/error.hpp"
#include "io/hdf5_transaction.hpp"

namespace corpuscle::hdf5 {
namespace {

static_assert(sizeof(hid_t) == sizeof(std::int64_t), "HDF5 1.10 or newer is needed");

/// Closes one HDF5 object when the scope ends.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }  // NOLINT: the C API takes plain ids

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

// HDF5 must not print its own stack, and must not try to write a full disk again while the process exits.
void prepare_library() {
  static const bool once = [] {
    H5dont_atexit();
    return H5open() >= 0;
  }();
  (void)once;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

// Keeps the innermost message and, where there is one, the text of the system's errno.
herr_t collect_reason(unsigned, const H5E_error2_t* error, void* data) {
  auto& reason = *static_cast<std::pair<std::string, std::string>*>(data);
  const std::string text = error->desc != nullptr ? error->desc : "";
  if (reason.first.empty()) reason.first = text;
  const std::string key = "error message = '";
  if (const auto begin = text.find(key); reason.second.empty() && begin != std::string::npos) {
    const auto from = begin + key.size();
    reason.second = text.substr(from, text.find('\'', from) - from);
  }
  return 0;
}

std::string last_reason() {
  std::pair<std::string, std::string> reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, collect_reason, &reason);
  H5Eclear2(H5E_DEFAULT);
  if (!reason.second.empty()) return reason.second;
  return reason.first.empty() ? "unknown reason" : reason.first;
}

template <class T>
hid_t native_type();
template <>
hid_t native_type<double>() { return H5T_NATIVE_DOUBLE; }
template <>
hid_t native_type<float>() { return H5T_NATIVE_FLOAT; }
template <>
hid_t native_type<std::int64_t>() { return H5T_NATIVE_INT64; }
template <>
hid_t native_type<std::int32_t>() { return H5T_NATIVE_INT32; }
template <>
hid_t native_type<std::uint8_t>() { return H5T_NATIVE_UINT8; }

hid_t utf8_string_type() {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

hid_t file_access() {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
#if (H5_VERSION_GE(1, 10, 7) && !H5_VERSION_GE(1, 12, 0)) || H5_VERSION_GE(1, 12, 1)
  H5Pset_file_locking(access, false, true);  // a reader with the file open must not stop the run, nor the run the reader
#endif
  return access;
}

std::vector<hsize_t> to_dimensions(const Shape& shape) { return {shape.begin(), shape.end()}; }

std::size_t product(const Shape& shape) {
  std::size_t n = 1;
  for (const auto extent : shape) n *= extent;
  return n;
}

[[noreturn]] void fail_path(const std::filesystem::path& path, const std::string& doing) {
  throw OutputError(fmt::format("{}: {} failed: {}", path.string(), doing, last_reason()));
}

}  // namespace

File::File(std::int64_t id, std::filesystem::path path) : id_(id), path_(std::move(path)) {}

File File::create(const std::filesystem::path& path) {
  prepare_library();
  std::error_code ignored;
  std::filesystem::remove(journal_path(path), ignored);  // of a file of this name that is no more
  const Handle access(file_access(), H5Pclose);
  const hid_t id = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  if (id < 0) fail_path(path, "creating the file");
  return {id, path};
}

File File::open_for_append(const std::filesystem::path& path) {
  prepare_library();
  recover(path);
  const Handle access(file_access(), H5Pclose);
  use_transactions(access);
  const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDWR, access);
  if (id < 0) fail_path(path, "opening the file for writing");
  File file(id, path);
  file.transaction_ = transaction_of(id);
  file.transaction_->begin(file.transaction_->allocated);
  return file;
}

File File::open_for_reading(const std::filesystem::path& path) {
  prepare_library();
  const Handle access(file_access(), H5Pclose);
  const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access);
  if (id < 0) fail_path(path, "opening the file for reading");
  return {id, path};
}

File::File(File&& other) noexcept
    : id_(std::exchange(other.id_, -1)), path_(std::move(other.path_)), transaction_(std::move(other.transaction_)) {}

File& File::operator=(File&& other) noexcept {
  std::swap(id_, other.id_);
  std::swap(path_, other.path_);
  std::swap(transaction_, other.transaction_);
  return *this;
}

File::~File() {
  if (id_ >= 0) H5Fclose(id_);
}

void File::close() {
  if (id_ < 0) return;
  check(H5Fflush(id_, H5F_SCOPE_GLOBAL), "writing to disk");
  check(H5Fclose(std::exchange(id_, -1)), "closing the file");
  const auto transaction = std::move(transaction_);
  if (transaction) transaction->commit(path_);
}

void File::fail(const std::string& doing) const { fail_path(path_, doing); }

std::int64_t File::check(std::int64_t result, const std::string& doing) const {
  if (result < 0) fail(doing);
  return result;
}

bool File::exists(const std::string& name) const {
  // H5Lexists asks for each part of the path in turn, so walk down.
  for (std::size_t at = name.find('/', 1); at != std::string::npos; at = name.find('/', at + 1)) {
    if (H5Lexists(id_, name.substr(0, at).c_str(), H5P_DEFAULT) <= 0) return false;
  }
  return H5Lexists(id_, name.c_str(), H5P_DEFAULT) > 0;
}

void File::create_group(const std::string& name) {
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  const Handle group(check(H5Gcreate2(id_, name.c_str(), links, H5P_DEFAULT, H5P_DEFAULT), "creating group " + name), H5Gclose);
}

void File::set_numbers(const std::string& object, const std::string& name, std::int64_t type, const void* values, std::size_t count, bool scalar) {
  const std::string doing = "writing attribute " + name + " of " + object;
  const Handle owner(check(H5Oopen(id_, object.c_str(), H5P_DEFAULT), doing), H5Oclose);
  if (H5Aexists(owner, name.c_str()) > 0) {
    // Overwriting in place (the common case: a counter) leaves the file valid at every moment.
    const Handle old(check(H5Aopen(owner, name.c_str(), H5P_DEFAULT), doing), H5Aclose);
    const Handle old_space(check(H5Aget_space(old), doing), H5Sclose);
    if (static_cast<std::size_t>(H5Sget_simple_extent_npoints(old_space)) == count) {
      check(H5Awrite(old, type, values), doing);
      return;
    }
    check(H5Adelete(owner, name.c_str()), doing);
  }
  const hsize_t extent = count;
  const Handle space(check(scalar ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &extent, nullptr), doing), H5Sclose);
  const Handle attribute(check(H5Acreate2(owner, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), doing), H5Aclose);
  check(H5Awrite(attribute, type, values), doing);
}

void File::set_attribute(const std::string& object, const std::string& name, double value) {
  set_numbers(object, name, H5T_NATIVE_DOUBLE, &value, 1, true);
}

void File::set_attribute(const std::string& object, const std::string& name, std::int64_t value) {
  set_numbers(object, name, H5T_NATIVE_INT64, &value, 1, true);
}

void File::set_attribute(const std::string& object, const std::string& name, std::span<const double> values) {
  set_numbers(object, name, H5T_NATIVE_DOUBLE, values.data(), values.size(), false);
}

void File::set_attribute(const std::string& object, const std::string& name, std::span<const std::int64_t> values) {
  set_numbers(object, name, H5T_NATIVE_INT64, values.data(), values.size(), false);
}

void File::set_attribute(const std::string& object, const std::string& name, const std::string& value) {
  const Handle type(utf8_string_type(), H5Tclose);
  const char* text = value.c_str();
  set_numbers(object, name, type, &text, 1, true);
}

void File::set_ascii_attribute(const std::string& object, const std::string& name, const std::string& value) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, std::max<std::size_t>(value.size(), 1));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  set_numbers(object, name, type, value.c_str(), 1, true);
}

std::string File::string_attribute(const std::string& object, const std::string& name) const {
  const std::string doing = "reading attribute " + name + " of " + object;
  const Handle attribute(check(H5Aopen_by_name(id_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), doing), H5Aclose);
  const Handle stored(check(H5Aget_type(attribute), doing), H5Tclose);
  const Handle space(check(H5Aget_space(attribute), doing), H5Sclose);
  // Several texts, or none, would be written behind the one there is room for.
  if (H5Tget_class(stored) != H5T_STRING || H5Sget_simple_extent_npoints(space) != 1) fail(doing + " as text");
  if (H5Tis_variable_str(stored) <= 0) {
    require_room("attribute " + name + " of " + object, static_cast<double>(H5Tget_size(stored)));
    std::string text(H5Tget_size(stored), '\0');
    check(H5Aread(attribute, stored, text.data()), doing);
    return text.substr(0, text.find('\0'));
  }
  const Handle type(utf8_string_type(), H5Tclose);
  char* text = nullptr;
  check(H5Aread(attribute, type, &text), doing);
  std::string result = text != nullptr ? text : "";
  H5free_memory(text);
  return result;
}

std::vector<double> File::numbers_attribute(const std::string& object, const std::string& name) const {
  const std::string doing = "reading attribute " + name + " of " + object;
  const Handle attribute(check(H5Aopen_by_name(id_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), doing), H5Aclose);
  const Handle space(check(H5Aget_space(attribute), doing), H5Sclose);
  const Handle stored(check(H5Aget_type(attribute), doing), H5Tclose);
  const auto count = check(H5Sget_simple_extent_npoints(space), doing);
  require_room("attribute " + name + " of " + object, static_cast<double>(count) * static_cast<double>(H5Tget_size(stored)));
  std::vector<double> values(static_cast<std::size_t>(count));
  check(H5Aread(attribute, H5T_NATIVE_DOUBLE, values.data()), doing);
  return values;
}

double File::number_attribute(const std::string& object, const std::string& name) const {
  const auto values = numbers_attribute(object, name);
  if (values.size() != 1) fail("reading attribute " + name + " of " + object + " as a number");
  return values.front();
}

template <class T>
void File::write(const std::string& name, std::span<const T> values, const Shape& shape) {
  const std::string doing = "writing " + name;
  if (values.size() != product(shape)) throw std::logic_error(name + ": values don't fill the shape");
  const auto extents = to_dimensions(shape);
  const Handle space(check(H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr), doing), H5Sclose);
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  const Handle data(check(H5Dcreate2(id_, name.c_str(), native_type<T>(), space, links, H5P_DEFAULT, H5P_DEFAULT), doing), H5Dclose);
  if (values.empty()) return;  // HDF5 refuses to write nothing from nowhere
  check(H5Dwrite(data, native_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), doing);
}

void File::write_strings(const std::string& name, const std::vector<std::string>& values) {
  const std::string doing = "writing " + name;
  std::vector<const char*> texts;
  for (const auto& value : values) texts.push_back(value.c_str());
  const hsize_t extent = values.size();
  const Handle type(utf8_string_type(), H5Tclose);
  const Handle space(check(H5Screate_simple(1, &extent, nullptr), doing), H5Sclose);
  const Handle data(check(H5Dcreate2(id_, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), doing), H5Dclose);
  check(H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data()), doing);
}

std::vector<std::string> File::read_strings(const std::string& name) const {
  const std::string doing = "reading " + name;
  const Handle data(check(H5Dopen2(id_, name.c_str(), H5P_DEFAULT), doing), H5Dclose);
  const Handle space(check(H5Dget_space(data), doing), H5Sclose);
  const Handle type(utf8_string_type(), H5Tclose);
  const auto count = static_cast<std::size_t>(check(H5Sget_simple_extent_npoints(space), doing));
  require_stored(name, {count}, sizeof(std::uint64_t));  // the address of a text takes 16 bytes in the file
  std::vector<char*> texts(count);
  check(H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data()), doing);
  std::vector<std::string> values(texts.begin(), texts.end());
  H5Dvlen_reclaim(type, space, H5P_DEFAULT, texts.data());
  return values;
}

template <class T>
void File::create_rows(const std::string& name, const RowLayout& layout) {
  const std::string doing = "creating " + name;
  auto extents = to_dimensions(layout.row_shape);
  extents.insert(extents.begin(), 0);
  auto limits = extents;
  limits[0] = H5S_UNLIMITED;
  auto chunk = extents;
  const std::size_t row_bytes = std::max<std::size_t>(sizeof(T) * product(layout.row_shape), 1);
  chunk[0] = layout.chunk_rows > 0 ? layout.chunk_rows : std::clamp<std::size_t>((std::size_t{64} << 10) / row_bytes, 1, 1024);
  for (auto& extent : chunk) extent = std::max<hsize_t>(extent, 1);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  check(H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data()), doing);
  const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  const Handle space(check(H5Screate_simple(static_cast<int>(extents.size()), extents.data(), limits.data()), doing), H5Sclose);
  const Handle data(check(H5Dcreate2(id_, name.c_str(), native_type<T>(), space, links, properties, H5P_DEFAULT), doing), H5Dclose);
  if (!layout.unit.empty()) set_attribute(name, "unit", layout.unit);
  if (!layout.description.empty()) set_attribute(name, "description", layout.description);
}

template <class T>
void File::append(const std::string& name, std::span<const T> values) {
  const std::string doing = "appending to " + name;
  const Handle data(check(H5Dopen2(id_, name.c_str(), H5P_DEFAULT), doing), H5Dclose);
  auto extents = to_dimensions(shape(name));
  std::size_t row = 1;
  for (std::size_t k = 1; k < extents.size(); ++k) row *= extents[k];
  if (values.empty() && row == 0) return;
  if (values.size() % row != 0) throw std::logic_error(name + ": values aren't whole rows");
  std::vector<hsize_t> start(extents.size(), 0);
  start[0] = extents[0];
  auto count = extents;
  count[0] = values.size() / row;
  extents[0] += count[0];
  check(H5Dset_extent(data, extents.data()), doing);
  const Handle file_space(check(H5Dget_space(data), doing), H5Sclose);
  check(H5Sselect_hyperslab(file_space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr), doing);
  const Handle memory(check(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), doing), H5Sclose);
  check(H5Dwrite(data, native_type<T>(), memory, file_space, H5P_DEFAULT, values.data()), doing);
}

void File::set_row_count(const std::string& name, std::size_t rows) {
  const std::string doing = "resizing " + name;
  const Handle data(check(H5Dopen2(id_, name.c_str(), H5P_DEFAULT), doing), H5Dclose);
  auto extents = to_dimensions(shape(name));
  extents.at(0) = rows;
  check(H5Dset_extent(data, extents.data()), doing);
}

Shape File::shape(const std::string& name) const {
  const std::string doing = "reading the shape of " + name;
  const Handle data(check(H5Dopen2(id_, name.c_str(), H5P_DEFAULT), doing), H5Dclose);
  const Handle space(check(H5Dget_space(data), doing), H5Sclose);
  std::vector<hsize_t> extents(static_cast<std::size_t>(check(H5Sget_simple_extent_ndims(space), doing)));
  check(H5Sget_simple_extent_dims(space, extents.data(), nullptr), doing);
  return {extents.begin(), extents.end()};
}

void File::require_stored(const std::string& name, const Shape& shape, std::size_t element_bytes) const {
  // A damaged or malicious file may claim any shape; memory is asked for only when the file is large enough to hold the numbers.
  const Handle data(check(H5Dopen2(id_, name.c_str(), H5P_DEFAULT), "reading " + name), H5Dclose);
  const Handle properties(check(H5Dget_create_plist(data), "reading " + name), H5Pclose);
  const double compression = H5Pget_nfilters(properties) > 0 ? 1000 : 1;  // deflate can't do better
  double asked = static_cast<double>(element_bytes);
  for (const auto extent : shape) asked *= static_cast<double>(extent);
  require_room(name, asked / compression);
}

void File::require_room(const std::string& name, double bytes) const {
  hsize_t file_bytes = 0;
  check(H5Fget_filesize(id_, &file_bytes), "reading the size of the file");
  if (bytes > static_cast<double>(file_bytes))
    throw OutputError(fmt::format("{}: {} claims to hold {:.3g} bytes, more than the file; it is damaged", path_.string(), name, bytes));
}

template <class T>
Array<T> File::read(const std::string& name) const {
  const std::string doing = "reading " + name;
  Array<T> result{shape(name), {}};
  const Handle data(check(H5Dopen2(id_, name.c_str(), H5P_DEFAULT), doing), H5Dclose);
  const Handle stored(check(H5Dget_type(data), doing), H5Tclose);
  require_stored(name, result.shape, H5Tget_size(stored));
  result.values.resize(product(result.shape));
  if (!result.values.empty()) check(H5Dread(data, native_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, result.values.data()), doing);
  return result;
}

template <class T>
Array<T> File::read_rows(const std::string& name, std::size_t first, std::size_t count) const {
  const std::string doing = "reading " + name;
  Array<T> result{shape(name), {}};
  if (result.shape.empty() || first + count > result.shape[0]) fail(doing + ": rows beyond its end");
  result.shape[0] = count;
  const Handle data(check(H5Dopen2(id_, name.c_str(), H5P_DEFAULT), doing), H5Dclose);
  const Handle stored(check(H5Dget_type(data), doing), H5Tclose);
  require_stored(name, result.shape, H5Tget_size(stored));
  result.values.resize(product(result.shape));
  if (result.values.empty()) return result;
  std::vector<hsize_t> start(result.shape.size(), 0);
  start[0] = first;
  const auto extents = to_dimensions(result.shape);
  const Handle file_space(check(H5Dget_space(data), doing), H5Sclose);
  check(H5Sselect_hyperslab(file_space, H5S_SELECT_SET, start.data(), nullptr, extents.data(), nullptr), doing);
  const Handle memory(check(H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr), doing), H5Sclose);
  check(H5Dread(data, native_type<T>(), memory, file_space, H5P_DEFAULT, result.values.data()), doing);
  return result;
}

#define CORPUSCLE_HDF5_TYPE(T)                                                         \
  template void File::write<T>(const std::string&, std::span<const T>, const Shape&); \
  template void File::create_rows<T>(const std::string&, const RowLayout&);           \
  template void File::append<T>(const std::string&, std::span<const T>);              \
  template Array<T> File::read<T>(const std::string&) const;                          \
  template Array<T> File::read_rows<T>(const std::string&, std::size_t, std::size_t) const;
CORPUSCLE_HDF5_TYPE(double)
CORPUSCLE_HDF5_TYPE(float)
CORPUSCLE_HDF5_TYPE(std::int64_t)
CORPUSCLE_HDF5_TYPE(std::int32_t)
CORPUSCLE_HDF5_TYPE(std::uint8_t)
#undef CORPUSCLE_HDF5_TYPE

}  // namespace corpuscle::hdf5
