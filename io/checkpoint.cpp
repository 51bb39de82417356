#include "io/checkpoint.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>

#include "core/error.hpp"
#include "io/durable.hpp"

namespace corpuscle {
namespace {

namespace fs = std::filesystem;

constexpr const char* format_name = "corpuscle checkpoint 1";
constexpr std::array<unsigned char, 8> end_mark{'c', 'o', 'r', 'p', 'h', 'a', 's', 'h'};
/// Limits of what a checkpoint may say, far beyond those of any run: numbers that become integers, lengths and memory.
constexpr double largest_count = 9e15, most_nodes_along = 1e6, most_stages = 1e3;
constexpr std::size_t trailer_bytes = end_mark.size() + sizeof(std::uint64_t);

[[noreturn]] void fail(const fs::path& path, const std::string& what) { throw OutputError(fmt::format("{}: {}", path.string(), what)); }

/// A file descriptor that is closed at the end of the scope.
struct Descriptor {
  int number;
  Descriptor(const fs::path& path, int flags) : number(::open(path.c_str(), flags | O_CLOEXEC)) {}
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
};

/// Hash of the first `size` bytes.
std::uint64_t hash_of(const fs::path& path, int file, std::uint64_t size) {
  Hash hash;
  std::vector<unsigned char> block(std::size_t{1} << 20);
  for (std::uint64_t at = 0; at < size;) {
    const ssize_t got = ::pread(file, block.data(), std::min<std::uint64_t>(block.size(), size - at), static_cast<off_t>(at));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) fail(path, fmt::format("reading failed: {}", got < 0 ? std::strerror(errno) : "the file ends early"));
    hash.add({block.data(), static_cast<std::size_t>(got)});
    at += static_cast<std::uint64_t>(got);
  }
  return hash.value();
}

std::array<unsigned char, trailer_bytes> trailer(std::uint64_t hash) {
  std::array<unsigned char, trailer_bytes> bytes{};
  std::copy(end_mark.begin(), end_mark.end(), bytes.begin());
  for (std::size_t i = 0; i < sizeof hash; ++i) bytes[end_mark.size() + i] = static_cast<unsigned char>(hash >> (8 * i));
  return bytes;
}

std::string population_name(int direction) { return fmt::format("/fluid/population_{:02}", direction); }

void write_contents(const fs::path& path, const Checkpoint& checkpoint, std::int64_t sequence, const PopulationSource& population) {
  auto file = hdf5::File::create(path);
  const auto numbers = [&](const std::string& name, const std::vector<double>& values, const hdf5::Shape& shape) {
    file.write<double>(name, std::span<const double>(values), shape);
  };
  const SuspensionState& state = checkpoint.state;
  file.set_attribute("/", "format", format_name);
  file.set_attribute("/", "scene", checkpoint.scene);
  file.set_attribute("/", "version", checkpoint.version);
  file.set_attribute("/", "git_revision", checkpoint.git_revision);
  file.set_attribute("/", "sequence", sequence);
  file.set_attribute("/", "step", state.step);
  file.set_attribute("/", "seconds", checkpoint.seconds);
  const std::array<std::int64_t, 3> nodes{checkpoint.nodes[0], checkpoint.nodes[1], checkpoint.nodes[2]};
  file.set_attribute("/", "nodes", std::span<const std::int64_t>(nodes));
  numbers("/lattice", checkpoint.lattice, {checkpoint.lattice.size()});
  numbers("/summary", checkpoint.summary, {checkpoint.summary.size()});
  if (!checkpoint.statistics.empty()) numbers("/statistics", checkpoint.statistics, {checkpoint.statistics.size()});
  numbers("/vertices/positions", state.positions, {state.positions.size() / 3, 3});
  numbers("/vertices/velocities", state.velocities, {state.velocities.size() / 3, 3});
  numbers("/vertices/velocities_before", state.motion.before, {state.motion.before.size() / 3, 3});
  numbers("/vertices/velocities_before_that", state.motion.before_that, {state.motion.before_that.size() / 3, 3});
  file.set_attribute("/vertices", "steps", state.motion.steps);
  file.set_attribute("/vertices", "stages", state.motion.stages);
  const hdf5::Shape field{static_cast<std::size_t>(nodes[2]), static_cast<std::size_t>(nodes[1]), static_cast<std::size_t>(nodes[0])};
  file.create_group("/fluid");
  for (int q = 0; q < 19; ++q) {
    const Population values = population(q);
    file.set_attribute("/fluid", "precision", std::holds_alternative<std::vector<double>>(values) ? "double" : "single");
    std::visit([&]<class T>(const std::vector<T>& v) { file.write<T>(population_name(q), std::span<const T>(v), field); }, values);
  }
  file.close();
}

}  // namespace

std::vector<double> lattice_numbers(const LatticeParameters& lattice) {
  std::vector<double> numbers{lattice.radius,     lattice.relaxation_time,  lattice.viscosity,     lattice.shear_rate,
                              lattice.wall_velocity, lattice.body_force, lattice.contact_strength, lattice.contact_range};
  for (const auto& type : lattice.cells) {
    const auto& m = type.moduli;
    numbers.insert(numbers.end(), {double(type.count), double(type.vertices), type.volume, type.area, type.stretching_force, m.shear, m.area_dilation,
                                   m.bending, m.bending_constant, m.global_area, m.volume});
  }
  return numbers;
}

void CheckpointStore::write(const Checkpoint& checkpoint, const PopulationSource& population) {
  const fs::path temporary = directory_ / temporary_name, target = directory_ / names[1 - newest_];
  std::error_code error;
  try {
    write_contents(temporary, checkpoint, sequence_ + 1, population);
    seal_checkpoint(temporary);
    fs::rename(temporary, target, error);
    if (error) fail(target, fmt::format("renaming {} failed: {}", temporary_name, error.message()));
  } catch (const OutputError&) {
    fs::remove(temporary, error);
    throw;
  }
  sync_directory(directory_);
  newest_ = 1 - newest_;
  ++sequence_;
}

void CheckpointStore::go_on_after(const CheckpointFile& file) {
  newest_ = file.path().filename() == names[1] ? 1 : 0;
  sequence_ = file.sequence();
}

void seal_checkpoint(const fs::path& path) {
  const Descriptor file(path, O_RDWR);
  if (file.number < 0) fail(path, fmt::format("opening the file failed: {}", std::strerror(errno)));
  const std::uint64_t size = fs::file_size(path);
  int error = write_at(file.number, size, trailer(hash_of(path, file.number, size)));
  if (error == 0) error = sync_file(file.number);
  if (error != 0) fail(path, fmt::format("writing to disk failed: {}", std::strerror(error)));
}

void verify_checkpoint(const fs::path& path) {
  const Descriptor file(path, O_RDONLY);
  if (file.number < 0) fail(path, fmt::format("opening the checkpoint failed: {}", std::strerror(errno)));
  std::error_code error;
  const std::uint64_t size = fs::file_size(path, error);
  std::array<unsigned char, trailer_bytes> found{};
  if (error || size < trailer_bytes || ::pread(file.number, found.data(), found.size(), static_cast<off_t>(size - trailer_bytes)) != ssize_t(trailer_bytes) ||
      !std::equal(end_mark.begin(), end_mark.end(), found.begin()))
    fail(path, "is no whole checkpoint: its end is missing");
  if (found != trailer(hash_of(path, file.number, size - trailer_bytes))) fail(path, "is damaged: its bytes don't have the hash that was written with them");
}

CheckpointFile::CheckpointFile(const fs::path& path)
    : file_([&] {
        verify_checkpoint(path);
        return hdf5::File::open_for_reading(path);
      }()) {
  if (file_.string_attribute("/", "format") != format_name)
    fail(path, fmt::format("is of the kind \"{}\", but this version reads \"{}\"", file_.string_attribute("/", "format"), format_name));
  Checkpoint& c = contents_;
  const auto in_range = [&](const char* name, double value, double least, double most) {
    if (!(value >= least && value <= most)) fail(path, fmt::format("contradicts itself: {} is {}", name, value));
    return value;
  };
  const auto whole = [&](const char* object, const char* name, double least, double most) {
    return static_cast<std::int64_t>(in_range(name, file_.number_attribute(object, name), least, most));
  };
  c.scene = file_.string_attribute("/", "scene");
  c.version = file_.string_attribute("/", "version");
  c.git_revision = file_.string_attribute("/", "git_revision");
  c.seconds = file_.number_attribute("/", "seconds");
  sequence_ = whole("/", "sequence", 0, largest_count);
  c.state.step = whole("/", "step", 0, largest_count);
  const auto nodes = file_.numbers_attribute("/", "nodes");
  if (nodes.size() != 3) fail(path, "has no three numbers of nodes");
  for (std::size_t k = 0; k < 3; ++k) c.nodes[k] = static_cast<int>(in_range("nodes", nodes[k], 1, most_nodes_along));
  c.lattice = file_.read<double>("/lattice").values;
  c.summary = file_.read<double>("/summary").values;
  if (file_.exists("/statistics")) c.statistics = file_.read<double>("/statistics").values;
  c.state.positions = file_.read<double>("/vertices/positions").values;
  c.state.velocities = file_.read<double>("/vertices/velocities").values;
  c.state.motion.before = file_.read<double>("/vertices/velocities_before").values;
  c.state.motion.before_that = file_.read<double>("/vertices/velocities_before_that").values;
  c.state.motion.steps = whole("/vertices", "steps", 0, largest_count);
  c.state.motion.stages = whole("/vertices", "stages", 1, most_stages);
  double_precision_ = file_.string_attribute("/fluid", "precision") == "double";
  const auto matches = [&](const std::vector<double>& values, bool may_be_empty) {
    return values.size() == c.state.positions.size() || (may_be_empty && values.empty());
  };
  if (c.state.positions.size() % 3 != 0 || !matches(c.state.velocities, false) || !matches(c.state.motion.before, true) ||
      !matches(c.state.motion.before_that, true))
    fail(path, "contradicts itself: its arrays don't have the same length");
}

Population CheckpointFile::population(int direction) const {
  const std::string name = population_name(direction);
  const auto& nodes = contents_.nodes;
  const hdf5::Shape expected{static_cast<std::size_t>(nodes[2]), static_cast<std::size_t>(nodes[1]), static_cast<std::size_t>(nodes[0])};
  if (file_.shape(name) != expected) fail(path(), fmt::format("contradicts itself: {} doesn't have a number for each node", name));
  if (double_precision_) return file_.read<double>(name).values;
  return file_.read<float>(name).values;
}

CheckpointFile open_newest_checkpoint(const fs::path& directory, std::vector<std::string>& notes) {
  std::optional<CheckpointFile> newest;
  bool any = false;
  for (const char* name : CheckpointStore::names) {
    std::error_code error;
    if (!fs::exists(directory / name, error)) continue;
    any = true;
    try {
      CheckpointFile file(directory / name);
      if (!newest || file.sequence() > newest->sequence()) newest.emplace(std::move(file));
    } catch (const OutputError& damaged) {
      notes.push_back(fmt::format("{}; it is left out", damaged.what()));
    }
  }
  if (newest) return std::move(*newest);
  if (any) throw InputError(fmt::format("{} has no whole checkpoint ({}): start the run again with corpuscle run", directory.string(), fmt::join(notes, "; ")));
  throw InputError(fmt::format("{} holds no checkpoint (checkpoint-a.h5 or checkpoint-b.h5): "
                               "name the directory of a run that was started with corpuscle run --output",
                               directory.string()));
}

}  // namespace corpuscle
