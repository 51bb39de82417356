// The HDF5 wrapper: round trips, growing datasets, and errors that a user can act on.
#include <sys/resource.h>

#include <csignal>
#include <fstream>
#include <numeric>

#include "core/error.hpp"
#include "io/hdf5.hpp"
#include "tests/catch.hpp"
#include "tests/contains.hpp"
#include "tests/scratch.hpp"

using namespace corpuscle;

namespace {

/// Files of this process can't grow beyond `bytes` while it lives: a disk that is full, without one.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, old_handler_);
  }

 private:
  rlimit before_{};
  void (*old_handler_)(int) = nullptr;
};

}  // namespace

TEST_CASE("hdf5: attributes and fixed datasets survive a round trip", "[io]") {
  const ScratchFolder folder;
  const auto path = folder / "a.h5";
  const std::vector<double> numbers{1.5, -2, 3};
  {
    auto file = hdf5::File::create(path);
    file.create_group("/group/inner");
    file.set_attribute("/", "text", "η = 1 µPa·s");
    file.set_attribute("/", "empty", "");
    file.set_attribute("/group/inner", "number", 0.1);
    file.set_attribute("/group", "count", std::int64_t{5000000000});
    file.set_attribute("/group", "list", std::span<const double>(numbers));
    file.set_ascii_attribute("/group", "Type", "PolyData");
    file.set_attribute("/group", "count", std::int64_t{7});  // replaced
    file.write<double>("/deep/er/data", numbers, {3, 1});
    file.write_strings("/names", {"red cell", "", "bead"});
    file.close();
  }
  const auto file = hdf5::File::open_for_reading(path);
  CHECK(file.string_attribute("/", "text") == "η = 1 µPa·s");
  CHECK(file.string_attribute("/", "empty").empty());
  CHECK(file.number_attribute("/group/inner", "number") == 0.1);
  CHECK(file.number_attribute("/group", "count") == 7);
  CHECK(file.numbers_attribute("/group", "list") == numbers);
  CHECK(file.string_attribute("/group", "Type") == "PolyData");
  CHECK(file.shape("/deep/er/data") == hdf5::Shape{3, 1});
  CHECK(file.read<double>("/deep/er/data").values == numbers);
  CHECK(file.read_strings("/names") == std::vector<std::string>{"red cell", "", "bead"});
  CHECK(file.exists("/deep/er/data"));
  CHECK_FALSE(file.exists("/deep/no/data"));
}

TEST_CASE("hdf5: rows are appended across closing and opening, and can be cut", "[io]") {
  const ScratchFolder folder;
  const auto path = folder / "rows.h5";
  {
    auto file = hdf5::File::create(path);
    file.create_rows<float>("/rows", {.row_shape = {2, 3}, .unit = "dx", .description = "test", .chunk_rows = 4});
    file.create_rows<std::int64_t>("/numbers", {});
    file.close();
  }
  std::vector<float> expected;
  for (int round = 0; round < 5; ++round) {
    std::vector<float> rows(6 * static_cast<std::size_t>(round));
    std::iota(rows.begin(), rows.end(), static_cast<float>(expected.size()));
    expected.insert(expected.end(), rows.begin(), rows.end());
    auto file = hdf5::File::open_for_append(path);
    file.append<float>("/rows", rows);
    file.append<std::int64_t>("/numbers", std::vector<std::int64_t>{round});
    CHECK_THROWS_AS(file.append<float>("/rows", std::vector<float>(5)), std::logic_error);
    file.close();
  }
  auto file = hdf5::File::open_for_append(path);
  CHECK(file.shape("/rows") == hdf5::Shape{10, 2, 3});
  CHECK(file.read<float>("/rows").values == expected);
  CHECK(file.read<std::int64_t>("/numbers").values == std::vector<std::int64_t>{0, 1, 2, 3, 4});
  CHECK(file.string_attribute("/rows", "unit") == "dx");
  file.set_row_count("/rows", 3);
  expected.resize(18);
  CHECK(file.read<float>("/rows").values == expected);
}

TEST_CASE("hdf5: errors name the file and the reason", "[io]") {
  const ScratchFolder folder;
  CHECK_THROWS_AS(hdf5::File::create(folder / "missing/a.h5"), OutputError);
  CHECK_THROWS_WITH(hdf5::File::create(folder / "missing/a.h5"), Contains("a.h5") && Contains("No such file or directory"));
  CHECK_THROWS_WITH(hdf5::File::open_for_reading(folder / "none.h5"), Contains("none.h5") && Contains("No such file or directory"));
  std::ofstream(folder / "text.h5") << "not HDF5";
  CHECK_THROWS_WITH(hdf5::File::open_for_reading(folder / "text.h5"), Contains("text.h5") && Contains("signature"));
  auto file = hdf5::File::create(folder / "a.h5");
  CHECK_THROWS_WITH(file.read<double>("/nothing"), Contains("a.h5") && Contains("/nothing"));
  CHECK_THROWS_WITH(file.number_attribute("/", "nothing"), Contains("nothing"));
}

TEST_CASE("hdf5: a file may be read while it is open for writing", "[io]") {
  const ScratchFolder folder;
  auto writer = hdf5::File::create(folder / "a.h5");
  writer.write<double>("/x", std::vector<double>{1}, {1});
  writer.close();
  auto again = hdf5::File::open_for_append(folder / "a.h5");
  CHECK_NOTHROW(hdf5::File::open_for_reading(folder / "a.h5"));
}

TEST_CASE("hdf5: a full disk is an error with the system's reason", "[io]") {
  const ScratchFolder folder;
  auto file = hdf5::File::create(folder / "full.h5");
  file.create_rows<double>("/x", {.row_shape = {1000}});
  file.close();
  const FileSizeLimit limit(1 << 20);
  const auto fill = [&] {
    for (int i = 0; i < 1000; ++i) {
      auto again = hdf5::File::open_for_append(folder / "full.h5");
      again.append<double>("/x", std::vector<double>(1000, i));
      again.close();
    }
  };
  CHECK_THROWS_WITH(fill(), Contains("full.h5") && Contains("File too large"));
}

TEST_CASE("hdf5: what does not fit on the disk leaves the file as it was", "[io]") {
  const ScratchFolder folder;
  const auto path = folder / "x.h5";
  const std::vector<double> row(1000, 1.0);
  const auto append = [&](int rows) {
    auto file = hdf5::File::open_for_append(path);
    for (int i = 0; i < rows; ++i) file.append<double>("/x", row);
    file.close();
  };
  auto file = hdf5::File::create(path);
  file.create_rows<double>("/x", {.row_shape = {1000}});
  file.close();
  append(3);
  const auto size = std::filesystem::file_size(path);
  {
    const FileSizeLimit limit(1 << 20);  // stands for a quota or a full disk
    CHECK_THROWS_WITH(append(200), Contains("x.h5") && Contains("File too large"));
  }
  CHECK(std::filesystem::file_size(path) == size);
  CHECK(hdf5::File::open_for_reading(path).shape("/x") == hdf5::Shape{3, 1000});
  append(200);  // there is room again
  CHECK(hdf5::File::open_for_reading(path).shape("/x") == hdf5::Shape{203, 1000});
}
