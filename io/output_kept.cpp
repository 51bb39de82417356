#include "io/output_kept.hpp"

#include <fmt/format.h>

#include "io/checkpoint.hpp"
#include "io/hdf5.hpp"

namespace corpuscle {

namespace fs = std::filesystem;

std::string what_is_kept(const fs::path& directory) {
  std::error_code ignored;
  if (!fs::exists(directory / "run.h5", ignored)) return fmt::format("Nothing is left: run.h5 is no longer in {}.", directory.string());
  try {
    const auto file = hdf5::File::open_for_reading(directory / "run.h5");
    const std::size_t rows = file.shape("/series/step").at(0);
    if (rows == 0) return fmt::format("What was written until then is kept in {}: no sample yet.", directory.string());
    const auto last = file.read_rows<std::int64_t>("/series/step", rows - 1, 1).values;
    return fmt::format("What was written until then is kept in {}: the series up to step {} ({} samples), and whole snapshots.", directory.string(),
        last.at(0), rows);
  } catch (const std::exception& error) {
    return fmt::format("What was written until then is in {}, but can't be read ({}).", directory.string(), error.what());
  }
}

}  // namespace corpuscle
