// Checkpoint files: read back as written, the last two kept, damage noticed.
#include "io/checkpoint.hpp"

#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>

#include "core/error.hpp"
#include "tests/catch.hpp"
#include "tests/contains.hpp"
#include "tests/scratch.hpp"

using namespace corpuscle;

namespace {

Checkpoint numbered(std::int64_t step) {
  Checkpoint c;
  c.scene = "[box]\nsize = [1, 2, 3]\n";
  c.version = "1.2.3";
  c.git_revision = "abc";
  c.lattice = {1, 2.5, 1e-300};
  c.nodes = {3, 4, 5};
  c.seconds = 12.5;
  c.summary = {0.1, 0.2, 3};
  c.state.step = step;
  c.state.positions = {1, 2, 3, 4, 5, 1.0 / 3};
  c.state.velocities = {6, 5, 4, 3, 2, 1};
  c.state.motion = {step, 4, {1, 1, 1, 2, 2, 2}, {3, 3, 3, 4, 4, 4}};
  return c;
}

/// A population in which each number tells where it belongs.
template <class T>
Population population(int direction) {
  std::vector<T> values(60);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = T(direction + i / 64.0);
  return values;
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_bytes(const std::filesystem::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

}  // namespace

TEST_CASE("A checkpoint reads back as it was written, in both precisions", "[checkpoint]") {
  const ScratchFolder folder;
  CheckpointStore store(folder / "");
  store.write(numbered(7), population<float>);
  store.write(numbered(8), population<double>);
  std::vector<std::string> notes;
  const CheckpointFile file = open_newest_checkpoint(folder / "", notes);
  const Checkpoint &read = file.contents(), written = numbered(8);
  CHECK(notes.empty());
  CHECK(file.sequence() == 2);
  CHECK(file.double_precision());
  CHECK(read.scene == written.scene);
  CHECK(read.version == written.version);
  CHECK(read.lattice == written.lattice);
  CHECK(read.nodes == written.nodes);
  CHECK(read.seconds == written.seconds);
  CHECK(read.summary == written.summary);
  CHECK(read.state.step == 8);
  CHECK(read.state.positions == written.state.positions);
  CHECK(read.state.velocities == written.state.velocities);
  CHECK(read.state.motion.steps == 8);
  CHECK(read.state.motion.stages == 4);
  CHECK(read.state.motion.before == written.state.motion.before);
  CHECK(read.state.motion.before_that == written.state.motion.before_that);
  for (const int q : {0, 1, 18}) CHECK(file.population(q) == population<double>(q));
  const CheckpointFile older(folder / CheckpointStore::names[0]);
  CHECK_FALSE(older.double_precision());
  CHECK(older.contents().state.step == 7);
  CHECK(older.population(18) == population<float>(18));
}

TEST_CASE("The last two checkpoints are kept, and a store that goes on after one keeps that", "[checkpoint]") {
  const ScratchFolder folder;
  std::vector<std::string> notes;
  CheckpointStore store(folder / "");
  for (const int step : {1, 2, 3}) store.write(numbered(step), population<float>);
  CHECK(CheckpointFile(folder / "checkpoint-a.h5").contents().state.step == 3);
  CHECK(CheckpointFile(folder / "checkpoint-b.h5").contents().state.step == 2);
  CHECK_FALSE(std::filesystem::exists(folder / CheckpointStore::temporary_name));
  CheckpointStore other(folder / "");
  other.go_on_after(open_newest_checkpoint(folder / "", notes));
  other.write(numbered(3), population<float>);  // the same step again: still the newest
  CHECK(open_newest_checkpoint(folder / "", notes).path().filename() == "checkpoint-b.h5");
}

TEST_CASE("A checkpoint without cells has no vertices", "[checkpoint]") {
  const ScratchFolder folder;
  Checkpoint empty = numbered(1);
  empty.state.positions = empty.state.velocities = {};
  empty.state.motion = {};
  CheckpointStore(folder / "").write(empty, population<float>);
  CHECK(CheckpointFile(folder / "checkpoint-a.h5").contents().state.positions.empty());
}

TEST_CASE("A byte that is flipped, a cut, and a file that is something else are noticed, and the checkpoint before is taken", "[checkpoint]") {
  const ScratchFolder folder;
  CheckpointStore store(folder / "");
  store.write(numbered(1), population<float>);
  store.write(numbered(2), population<float>);
  const auto newest = folder / "checkpoint-b.h5";
  const std::string good = bytes_of(newest);
  int missed = 0;
  for (std::size_t at = 0; at < good.size(); at += 97) {
    std::string bad = good;
    bad[at] = char(bad[at] ^ (1 << (at % 8)));
    write_bytes(newest, bad);
    try {
      verify_checkpoint(newest);
      ++missed;
    } catch (const OutputError&) {
    }
  }
  CHECK(missed == 0);
  for (const std::size_t size : {good.size() - 1, good.size() / 2, std::size_t{20}, std::size_t{0}}) {
    write_bytes(newest, good.substr(0, size));
    CHECK_THROWS_WITH(verify_checkpoint(newest), Contains("checkpoint-b.h5") && Contains("its end is missing"));
  }
  write_bytes(newest, good + "x");
  CHECK_THROWS_WITH(verify_checkpoint(newest), Contains("its end is missing"));
  std::vector<std::string> notes;
  CHECK(open_newest_checkpoint(folder / "", notes).contents().state.step == 1);
  REQUIRE(notes.size() == 1);
  CHECK_THAT(notes[0], Contains("checkpoint-b.h5") && Contains("left out"));
  write_bytes(folder / "checkpoint-a.h5", "nothing");
  CHECK_THROWS_WITH(open_newest_checkpoint(folder / "", notes), Contains("no whole checkpoint"));
  std::filesystem::remove(folder / "checkpoint-a.h5");
  std::filesystem::remove(newest);
  CHECK_THROWS_WITH(open_newest_checkpoint(folder / "", notes), Contains("holds no checkpoint"));
}

TEST_CASE("A checkpoint that can't be written leaves those before it", "[checkpoint]") {
  const ScratchFolder folder;
  CheckpointStore store(folder / "");
  store.write(numbered(1), population<float>);
  const auto fails = [](int direction) -> Population { return direction < 5 ? population<float>(direction) : throw OutputError("no more"); };
  CHECK_THROWS_AS(store.write(numbered(2), fails), OutputError);
  CHECK_FALSE(std::filesystem::exists(folder / CheckpointStore::temporary_name));
  store.write(numbered(3), population<float>);
  CHECK(CheckpointFile(folder / "checkpoint-a.h5").contents().state.step == 1);
  CHECK(CheckpointFile(folder / "checkpoint-b.h5").contents().state.step == 3);
}

TEST_CASE("A checkpoint that was made to deceive, with the right hash, is refused before its numbers are used", "[checkpoint]") {
  const ScratchFolder folder;
  const auto path = folder / "checkpoint-a.h5";
  const auto deceive = [&](const std::function<void(hdf5::File&)>& change) {
    CheckpointStore(folder / "").write(numbered(1), population<float>);
    std::filesystem::resize_file(path, std::filesystem::file_size(path) - 16);  // the hash
    auto file = hdf5::File::open_for_append(path);
    change(file);
    file.close();
    seal_checkpoint(path);
    verify_checkpoint(path);
  };
  deceive([](hdf5::File&) {});
  CHECK(CheckpointFile(path).contents().state.step == 1);
  for (const char* name : {"sequence", "step"}) {
    deceive([&](hdf5::File& file) { file.set_attribute("/", name, -1.0); });
    CHECK_THROWS_WITH(CheckpointFile(path), Contains("contradicts itself: " + std::string(name) + " is -1"));
    deceive([&](hdf5::File& file) { file.set_attribute("/", name, std::numeric_limits<std::int64_t>::max()); });
    CHECK_THROWS_WITH(CheckpointFile(path), Contains("contradicts itself: " + std::string(name) + " is 9.22"));
  }
  for (const double stages : {0.0, 1e9, std::nan("")}) {
    deceive([&](hdf5::File& file) { file.set_attribute("/vertices", "stages", stages); });
    CHECK_THROWS_WITH(CheckpointFile(path), Contains("contradicts itself: stages is"));
  }
  for (const double n : {-3.0, 0.0, 1e12}) {
    deceive([&](hdf5::File& file) { file.set_attribute("/", "nodes", std::span<const double>(std::array{3.0, n, 5.0})); });
    CHECK_THROWS_WITH(CheckpointFile(path), Contains("contradicts itself: nodes is"));
  }
  deceive([](hdf5::File& file) {
    const std::array<std::int64_t, 3> nodes{3, 4, 6};
    file.set_attribute("/", "nodes", std::span<const std::int64_t>(nodes));
  });
  CHECK_THROWS_WITH(CheckpointFile(path).population(0), Contains("doesn't have a number for each node"));
}
