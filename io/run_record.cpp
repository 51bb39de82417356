#include "io/run_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/error.hpp"
#include "io/hdf5.hpp"
#include "io/hdf5_transaction.hpp"
#include "io/lock.hpp"
#include "physics/statistics/estimate.hpp"

namespace corpuscle {
namespace {

namespace fs = std::filesystem;
using analysis::CellQuantity;
using analysis::FlowOf;
using analysis::RunRecord;
using Eigen::Index;

constexpr std::size_t piece_values = std::size_t{1} << 20;  // that are read at a time
constexpr auto none = statistics::not_a_number;

const char* name_of(CellQuantity quantity) {
  switch (quantity) {
    case CellQuantity::centre: return "/cells/centre";
    case CellQuantity::velocity: return "/cells/velocity";
    case CellQuantity::gyration: return "/cells/gyration";
    case CellQuantity::stresslet: return "/cells/stresslet";
    case CellQuantity::volume: break;
  }
  return "/cells/volume";
}

constexpr std::array all_quantities{CellQuantity::centre, CellQuantity::velocity, CellQuantity::gyration, CellQuantity::stresslet, CellQuantity::volume};

/// What `read` gets from the file. A file that a run changes at this moment may look broken: then it is opened again, a few times.
template <class Read>
auto read_patiently(const fs::path& path, const Read& read) {
  constexpr int tries = 5;
  for (int i = 1;; ++i) {
    try {
      return read(hdf5::File::open_for_reading(path));
    } catch (const OutputError&) {
      if (i == tries) throw;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  }
}

/// Where on the grid the samples of a file lie.
struct Grid {
  std::vector<std::size_t> rows;  ///< of the file
  std::vector<Index> times;       ///< on the grid, ascending
  Index size() const { return times.empty() ? 0 : times.back() + 1; }
};

Grid grid_of(const std::vector<std::int64_t>& steps, std::int64_t every, const std::string& path, std::vector<std::string>& warnings) {
  Grid grid;
  std::size_t off = 0;
  for (std::size_t row = 0; row < steps.size(); ++row) {
    if (steps[row] < 0 || (row > 0 && steps[row] <= steps[row - 1])) {
      throw InputError(fmt::format("{}: /series/step doesn't ascend at sample {} ({}): the file was changed or damaged (corpuscle check tells more)", path, row, steps[row]));
    }
    if (steps[row] % every != 0) {
      off += row + 1 < steps.size() ? 1 : 0;  // the last sample is that of the end, whenever it comes
      continue;
    }
    grid.rows.push_back(row);
    grid.times.push_back(static_cast<Index>(steps[row] / every));
  }
  if (off > 0) warnings.push_back(fmt::format("{} samples lie between the times of series_every = {} steps and are left out", off, every));
  const auto missing = static_cast<std::size_t>(grid.size()) - grid.rows.size();
  if (missing > 10 * (grid.rows.size() + 10)) {
    throw InputError(fmt::format("{}: of {} samples up to step {} all but {} are missing: too few to analyse", path, grid.size(), steps.back(), grid.rows.size()));
  }
  if (missing > 0) warnings.push_back(fmt::format("{} of {} samples are missing: there is a gap in /series/step", missing, grid.size()));
  return grid;
}

class FileCells : public analysis::CellSeries {
 public:
  FileCells(fs::path path, Grid grid, Index cells) : path_(std::move(path)), grid_(std::move(grid)), cells_(cells) {}
  Index cells() const override { return cells_; }
  void visit(CellQuantity quantity, Index first, const Visitor& visitor) const override {
    const std::size_t width = static_cast<std::size_t>(cells_) * static_cast<std::size_t>(components_of(quantity));
    const std::size_t most = std::max<std::size_t>(piece_values / std::max<std::size_t>(width, 1), 1);
    const auto begin = static_cast<std::size_t>(std::lower_bound(grid_.times.begin(), grid_.times.end(), first) - grid_.times.begin());
    for (std::size_t i = begin; i < grid_.rows.size();) {
      // The longest run of rows that follow each other in the file.
      std::size_t count = 1;
      while (count < most && i + count < grid_.rows.size() && grid_.rows[i + count] == grid_.rows[i] + count) ++count;
      const auto piece = read_patiently(path_, [&](const hdf5::File& file) { return file.read_rows<double>(name_of(quantity), grid_.rows[i], count); });
      for (std::size_t k = 0; k < count; ++k) visitor(grid_.times[i + k], std::span(piece.values).subspan(k * width, width));
      i += count;
    }
  }

 private:
  fs::path path_;
  Grid grid_;
  Index cells_;
};

std::size_t rows_of(const hdf5::File& file, const std::string& name) {
  const auto shape = file.shape(name);
  return shape.empty() ? 0 : shape[0];
}

/// Column `column` of the rows of the grid, [grid size]; a dataset that is missing is all NaN.
std::vector<double> column_of(const hdf5::File& file, const std::string& name, const Grid& grid, std::size_t rows, std::size_t column, RunRecord& record) {
  std::vector<double> series(static_cast<std::size_t>(grid.size()), none);
  if (!file.exists(name)) {
    record.warnings.push_back(fmt::format("{} is missing in run.h5: what needs it cannot be computed", name));
    return series;
  }
  const auto data = file.read_rows<double>(name, 0, rows);
  if (rows == 0) return series;
  const std::size_t width = data.values.size() / rows;
  if (column >= width) throw OutputError(fmt::format("{}: {} has {} numbers a sample", record.directory, name, width));
  for (std::size_t i = 0; i < grid.rows.size(); ++i) series[static_cast<std::size_t>(grid.times[i])] = data.values[grid.rows[i] * width + column];
  return series;
}

void read_lattice(const hdf5::File& file, RunRecord& record) {
  const auto number = [&](const char* name) { return file.number_attribute("/lattice", name); };
  record.capillary_number = number("capillary_number");
  record.phi_geometric = number("phi_geometric");
  record.phi_nominal = number("phi_nominal");
  record.phi_effective = number("phi_effective");
  record.radius = number("radius");
  record.viscosity = number("viscosity");
  record.shear_rate = number("shear_rate");
  record.flow = !(record.shear_rate > 0) ? FlowOf::rest : number("body_force") != 0 ? FlowOf::poiseuille : FlowOf::shear;
  const auto nodes = file.numbers_attribute("/lattice", "nodes");
  if (nodes.size() != 3 || !(record.radius > 0) || !(record.viscosity > 0) || !(*std::min_element(nodes.begin(), nodes.end()) > 0)) {
    throw OutputError("/lattice has no box, radius or viscosity");
  }
  std::copy_n(nodes.begin(), 3, record.box.begin());
  for (int i = 0;; ++i) {
    const auto group = fmt::format("/lattice/cell_types/{}", i);
    if (!file.exists(group)) break;
    const auto of_type = [&](const char* name) { return file.number_attribute(group, name); };
    record.types.push_back({.name = file.string_attribute(group, "name"),
                            .count = static_cast<Index>(of_type("count")),
                            .effective_radius = of_type("effective_radius"),
                            .volume = of_type("volume"),
                            .effective_volume = of_type("effective_volume")});
  }
}

/// Whether all that is known of cells is there, and fits.
bool has_trajectories(const hdf5::File& file, RunRecord& record) {
  if (!file.exists("/cells")) return false;
  for (const auto quantity : all_quantities) {
    if (!file.exists(name_of(quantity))) {
      record.warnings.push_back(fmt::format("{} is missing in run.h5: the run is analysed without trajectories", name_of(quantity)));
      return false;
    }
    const auto shape = file.shape(name_of(quantity));
    const auto numbers = shape.size() == 3 ? shape[2] : shape.size() == 4 ? shape[2] * shape[3] : std::size_t{1};
    if (shape.size() < 2 || shape[1] != static_cast<std::size_t>(record.cell_count()) || numbers != static_cast<std::size_t>(components_of(quantity))) {
      throw OutputError(fmt::format("{} isn't of {} cells with {} numbers each", name_of(quantity), record.cell_count(), components_of(quantity)));
    }
  }
  record.type_of_cell = file.read<std::int32_t>("/cells/type").values;
  const auto types = static_cast<std::int32_t>(record.types.size());
  if (static_cast<Index>(record.type_of_cell.size()) != record.cell_count() ||
      !std::all_of(record.type_of_cell.begin(), record.type_of_cell.end(), [&](std::int32_t t) { return t >= 0 && t < types; })) {
    throw OutputError("/cells/type doesn't fit the types of cells");
  }
  return true;
}

RunRecord read(const hdf5::File& file, const fs::path& directory) {
  RunRecord record;
  record.directory = directory.string();
  if (const auto format = file.string_attribute("/", "format"); format != "corpuscle run 1") {
    throw OutputError("its format is '" + format.substr(0, 60) + "' instead of 'corpuscle run 1'");
  }
  read_lattice(file, record);
  const std::vector<std::string> scalars{"/series/relative_viscosity", "/series/wall_relative_viscosity", "/series/mean_deformation", "/series/volume_drift_max",
                                         "/series/area_drift_max",     "/series/bulk_particle_stress",    "/series/wall_shear_stress"};
  const bool trajectories = record.cell_count() > 0 && has_trajectories(file, record);
  std::size_t rows = rows_of(file, "/series/step");
  for (const auto& name : scalars)
    if (file.exists(name)) rows = std::min(rows, rows_of(file, name));
  for (const auto quantity : all_quantities)
    if (trajectories) rows = std::min(rows, rows_of(file, name_of(quantity)));

  const double every = file.number_attribute("/lattice", "series_every");
  if (!(every >= 1 && every < 9e15)) throw OutputError(fmt::format("/lattice has series_every = {}", every));
  const auto steps = file.read_rows<std::int64_t>("/series/step", 0, rows).values;
  const Grid grid = grid_of(steps, static_cast<std::int64_t>(every), (directory / "run.h5").string(), record.warnings);
  record.samples = static_cast<std::int64_t>(rows);
  record.interval = record.shear_rate > 0 ? record.shear_rate * every : none;
  record.strain = rows > 0 ? record.shear_rate * static_cast<double>(steps.back()) : 0;
  const auto column = [&](std::size_t which, std::size_t part) { return column_of(file, scalars[which], grid, rows, part, record); };
  record.relative_viscosity = column(0, 0);
  record.wall_relative_viscosity = column(1, 0);
  record.mean_deformation = column(2, 0);
  record.volume_drift_max = column(3, 0);
  record.area_drift_max = column(4, 0);
  if (file.exists(scalars[5])) {
    constexpr std::array<std::size_t, 4> parts{0, 4, 8, 2};  // xx, yy, zz, xz
    for (std::size_t k = 0; k < 4; ++k) record.bulk_stress[k] = column(5, parts[k]);
  } else {
    record.bulk_stress.fill(std::vector<double>(static_cast<std::size_t>(grid.size()), none));
  }
  const auto on_walls = column(6, 0);
  record.walls = record.shear_rate > 0 || std::any_of(on_walls.begin(), on_walls.end(), [](double s) { return std::isfinite(s); });
  if (trajectories) record.cells = std::make_shared<FileCells>(directory / "run.h5", grid, record.cell_count());
  return record;
}

bool stopped_by_guard(const fs::path& directory) {
  std::ifstream file(directory / "summary.json");
  const auto json = nlohmann::json::parse(file, nullptr, false);
  return json.is_object() && json.contains("stopped_by") && json["stopped_by"] == "guard";
}

}  // namespace

RunRecord read_run_record(const fs::path& directory) {
  std::error_code ignored;
  const fs::path path = directory / "run.h5";
  if (!fs::is_directory(directory, ignored)) {
    throw InputError(fmt::format("analyse {}: there is no such directory; give the one that `corpuscle run --output` wrote.", directory.string()));
  }
  if (!fs::exists(path, ignored)) {
    throw InputError(fmt::format("analyse {}: holds no run.h5; give the directory that `corpuscle run --output` wrote, or that of a sweep.", directory.string()));
  }
  try {
    RunRecord record = read_patiently(path, [&](const hdf5::File& file) { return read(file, directory); });
    if (const std::string holder = lock_holder(directory); !holder.empty()) {
      record.warnings.push_back(fmt::format("a run is writing here ({}): this is how far it is", holder));
    } else if (fs::exists(hdf5::journal_path(path), ignored)) {
      record.warnings.push_back("a write to run.h5 was cut off by a kill: corpuscle check --recover finishes it, or takes it back");
    }
    if (stopped_by_guard(directory)) record.warnings.push_back("a guard stopped the run: its last samples may be unphysical");
    return record;
  } catch (const OutputError& error) {
    std::string text = error.what();
    if (const std::string prefix = path.string() + ": "; text.starts_with(prefix)) text.erase(0, prefix.size());
    throw InputError(fmt::format("analyse {}: run.h5 can't be used: {} (corpuscle check {} tells what is wrong)", directory.string(), text, directory.string()));
  }
}

}  // namespace corpuscle
