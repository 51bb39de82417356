// HDF5 files change wholly or not at all.
#include "io/hdf5_transaction.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <numeric>

#include "core/error.hpp"
#include "io/durable.hpp"
#include "io/hdf5.hpp"
#include "tests/catch.hpp"
#include "tests/contains.hpp"
#include "tests/scratch.hpp"

using namespace corpuscle;

namespace {

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void create(const std::filesystem::path& path) {
  auto file = hdf5::File::create(path);
  file.create_rows<double>("/x", {.chunk_rows = 100});
  file.set_attribute("/", "rows", std::int64_t{0});
  file.close();
}

/// Appends 1000 rows 0, 1, 2, ... and counts them in an attribute.
void append(hdf5::File& file) {
  std::vector<double> values(1000);
  const auto rows = static_cast<std::int64_t>(file.shape("/x").at(0));
  std::iota(values.begin(), values.end(), double(rows));
  file.append<double>("/x", values);
  file.set_attribute("/", "rows", rows + 1000);
}

void check_rows(const std::filesystem::path& path, std::size_t rows) {
  const auto file = hdf5::File::open_for_reading(path);
  const auto values = file.read<double>("/x").values;
  REQUIRE(values.size() == rows);
  CHECK(file.number_attribute("/", "rows") == double(rows));
  for (std::size_t i = 0; i < rows; ++i) REQUIRE(values[i] == double(i));
}

}  // namespace

TEST_CASE("What is done between opening and closing is there after closing, and only then", "[hdf5]") {
  const ScratchFolder folder;
  const auto path = folder / "x.h5";
  create(path);
  for (std::size_t i = 0; i < 5; ++i) {
    const auto before = bytes_of(path);
    {
      auto file = hdf5::File::open_for_append(path);
      append(file);
      // Who reads now sees the old state.
      check_rows(path, 1000 * i);
    }  // not closed: as if nothing had been done
    CHECK(bytes_of(path) == before);
    auto file = hdf5::File::open_for_append(path);
    append(file);
    file.close();
    check_rows(path, 1000 * (i + 1));
    CHECK_FALSE(std::filesystem::exists(hdf5::journal_path(path)));
  }
  auto file = hdf5::File::open_for_append(path);
  file.set_row_count("/x", 1500);
  file.set_attribute("/", "rows", std::int64_t{1500});
  file.close();
  check_rows(path, 1500);
  auto again = hdf5::File::open_for_append(path);
  append(again);
  again.close();
  check_rows(path, 2500);
}

TEST_CASE("A process that ends while it writes leaves the old state, and what it has left behind the end does no harm", "[hdf5]") {
  const ScratchFolder folder;
  const auto path = folder / "x.h5";
  create(path);
  {
    auto file = hdf5::File::open_for_append(path);
    append(file);
    file.close();
  }
  const auto size = std::filesystem::file_size(path);
  if (const pid_t child = fork(); child == 0) {
    auto file = hdf5::File::open_for_append(path);
    for (int i = 0; i < 50; ++i) append(file);
    _exit(0);  // as a kill: nothing is closed
  } else {
    waitpid(child, nullptr, 0);
  }
  check_rows(path, 1000);
  CHECK(std::filesystem::file_size(path) >= size);
  auto file = hdf5::File::open_for_append(path);
  append(file);
  file.close();
  check_rows(path, 2000);
}

TEST_CASE("A whole journal is finished, one that is cut is dropped, and one of an older file of that name is removed", "[hdf5]") {
  const ScratchFolder folder;
  const auto path = folder / "x.h5", journal = hdf5::journal_path(path);
  create(path);
  const auto old_state = bytes_of(path);
  // Stopped after the journal was written and before anything was changed in place: the journal's folder entry can't be removed, the file can't be changed.
  auto file = hdf5::File::open_for_append(path);
  append(file);
  std::filesystem::create_directory(journal);
  CHECK_THROWS_AS(file.close(), OutputError);  // no place for the journal: the old state stays
  std::filesystem::remove(journal);
  CHECK(bytes_of(path) == old_state);

  std::ofstream(journal, std::ios::binary) << "corpjnl1 and no more";
  CHECK_FALSE(hdf5::recover(path));
  CHECK_FALSE(std::filesystem::exists(journal));
  CHECK(bytes_of(path) == old_state);

  std::ofstream(journal, std::ios::binary) << "of another file";
  create(path);
  CHECK_FALSE(std::filesystem::exists(journal));
}

TEST_CASE("A kill at any byte of the journal or of the changes in place leaves the old or the new state", "[hdf5]") {
  const ScratchFolder folder;
  const auto path = folder / "x.h5", journal = hdf5::journal_path(path), copy = folder / "journal";
  create(path);
  const auto before = folder / "before.h5";
  {
    auto file = hdf5::File::open_for_append(path);
    append(file);
    file.close();
  }
  std::filesystem::copy_file(path, before);
  {
    auto file = hdf5::File::open_for_append(path);
    append(file);
    std::ofstream{copy};
    std::filesystem::create_hard_link(copy, journal);  // keeps what is written into the journal when `close` removes it
    file.close();
  }
  check_rows(path, 2000);
  const auto new_state = bytes_of(path), notes = bytes_of(copy), old_state = bytes_of(before);
  const auto with_appended = old_state + new_state.substr(old_state.size());
  for (std::size_t i = 0; i <= 50; ++i) {
    const std::size_t size = notes.size() * i / 50;
    std::ofstream(path, std::ios::binary) << with_appended;
    std::ofstream(journal, std::ios::binary) << notes.substr(0, size);
    CHECK(hdf5::recover(path) == (size == notes.size()));
    check_rows(path, size == notes.size() ? 2000 : 1000);
  }
  // Half of the changes in place were made before the kill.
  auto half = with_appended;
  for (std::size_t i = 0; i < old_state.size() / 2; ++i) half[i] = new_state[i];
  std::ofstream(path, std::ios::binary) << half;
  std::ofstream(journal, std::ios::binary) << notes;
  CHECK(hdf5::recover(path));
  CHECK(bytes_of(path) == new_state);
}

TEST_CASE("A journal that was made up, with the right hash, touches nothing when its changes don't fill it", "[hdf5]") {
  const ScratchFolder folder;
  const auto path = folder / "x.h5", journal = hdf5::journal_path(path);
  create(path);
  const auto old_state = bytes_of(path);
  const auto number = [](std::uint64_t n) { return std::string(reinterpret_cast<const char*>(&n), sizeof n); };
  const auto with_hash = [&](const std::string& content) {
    Hash hash;
    hash.add({reinterpret_cast<const unsigned char*>(content.data()), content.size()});
    return content + number(hash.value());
  };
  const std::uint64_t many = std::uint64_t{1} << 60;
  const auto size = number(old_state.size());
  // Changes that aren't there, one that is longer than the journal, one that would wrap around, and bytes that belong to none.
  for (const std::string& content : {"corpjnl1" + number(many) + size, "corpjnl1" + number(1) + size + number(0) + number(many) + "abc",
                                     "corpjnl1" + number(1) + size + number(0) + number(~std::uint64_t{0}) + "abc", "corpjnl1" + number(0) + size + "abc"}) {
    std::ofstream(journal, std::ios::binary) << with_hash(content);
    CHECK_FALSE(hdf5::recover(path));
    CHECK_FALSE(std::filesystem::exists(journal));
    CHECK(bytes_of(path) == old_state);
  }
  std::ofstream(journal, std::ios::binary) << with_hash("corpjnl1" + number(1) + size + number(0) + number(3) + old_state.substr(0, 3));
  CHECK(hdf5::recover(path));
  CHECK(bytes_of(path) == old_state);
}
