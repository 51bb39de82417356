#include "io/run_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "io/lattice_numbers.hpp"

namespace corpuscle {
namespace {

/// One dataset of /series: where its numbers lie in a Sample.
struct SeriesQuantity {
  const char* name;
  const char* unit;
  hdf5::Shape shape;
  double* (*values)(Sample&);
  const char* description;
};

const std::vector<SeriesQuantity>& series_quantities() {
  static const std::vector<SeriesQuantity> table{
      {"strain", "1", {}, [](Sample& s) { return &s.strain; }, "shear rate times time; 0 at rest"},
      {"particle_stress", "rho0 dx^2/dt^2", {3, 3}, [](Sample& s) { return s.particle_stress.data(); },
       "stress of the cells, sum of stresslets / box volume; row: force, column: position"},
      {"bulk_particle_stress", "rho0 dx^2/dt^2", {3, 3}, [](Sample& s) { return s.bulk_particle_stress.data(); },
       "the same over the cells outside the wall layers / bulk volume"},
      {"wall_shear_stress", "rho0 dx^2/dt^2", {2}, [](Sample& s) { return s.wall_shear_stress.data(); },
       "xz stress at the lower and the upper wall; NaN without walls"},
      {"relative_viscosity", "1", {}, [](Sample& s) { return &s.relative_viscosity; },
       "1 + particle_stress_xz/(viscosity shear_rate), whole box; NaN at rest"},
      {"bulk_relative_viscosity", "1", {}, [](Sample& s) { return &s.bulk_relative_viscosity; },
       "the same in the bulk, 4 radii away from each wall; whole box where no bulk is left"},
      {"wall_relative_viscosity", "1", {}, [](Sample& s) { return &s.wall_relative_viscosity; },
       "mean of both wall shear stresses/(viscosity shear_rate); NaN without walls"},
      {"normal_stress_difference_1", "1", {}, [](Sample& s) { return &s.normal_stress_difference_1; },
       "N1 = (sigma_xx - sigma_zz)/(viscosity shear_rate); x flow, z gradient"},
      {"normal_stress_difference_2", "1", {}, [](Sample& s) { return &s.normal_stress_difference_2; },
       "N2 = (sigma_zz - sigma_yy)/(viscosity shear_rate); z gradient, y vorticity"},
      {"particle_pressure", "1", {}, [](Sample& s) { return &s.particle_pressure; }, "- trace(particle_stress)/3/(viscosity shear_rate)"},
      {"mean_deformation", "1", {}, [](Sample& s) { return &s.mean_deformation; }, "mean over the cells of D = (L-B)/(L+B) in the shear plane"},
      {"volume_drift_max", "1", {}, [](Sample& s) { return &s.volume_drift_max; }, "largest |V/V_0 - 1| of all cells"},
      {"area_drift_max", "1", {}, [](Sample& s) { return &s.area_drift_max; }, "largest |A/A_0 - 1| of all cells"},
      {"velocity_max", "dx/dt", {}, [](Sample& s) { return &s.velocity_max; }, "largest speed of a vertex"},
  };
  return table;
}

/// One dataset of /cells.
struct CellQuantity {
  const char* name;
  const char* unit;
  hdf5::Shape shape;  ///< of one cell
  const double* (*values)(const CellSample&);
  const char* description;
};

const std::vector<CellQuantity>& cell_quantities() {
  static const std::vector<CellQuantity> table{
      {"centre", "dx", {3}, [](const CellSample& c) { return c.centre.data(); }, "centroid of the enclosed volume, not wrapped into the box"},
      {"velocity", "dx/dt", {3}, [](const CellSample& c) { return c.velocity.data(); }, "mean velocity of the vertices"},
      {"gyration", "dx^2", {6}, [](const CellSample& c) { return c.gyration.data(); },
       "second moment of the enclosed volume / volume about the centre: xx yy zz xy xz yz"},
      {"stresslet", "rho0 dx^5/dt^2", {3, 3}, [](const CellSample& c) { return c.stresslet.data(); },
       "- sum F_a r_b over the vertices; row a: force on the fluid, column b: position"},
      {"volume", "dx^3", {}, [](const CellSample& c) { return &c.volume; }, "enclosed volume"},
      {"area", "dx^2", {}, [](const CellSample& c) { return &c.area; }, "surface area"},
      {"extent", "dx", {3}, [](const CellSample& c) { return c.extent.data(); }, "edges of the bounding box of the vertices along x, y and z"},
  };
  return table;
}

std::size_t size_of(const hdf5::Shape& shape) {
  std::size_t n = 1;
  for (const auto extent : shape) n *= extent;
  return n;
}

std::string in_series(const char* name) { return std::string("/series/") + name; }
std::string in_cells(const char* name) { return std::string("/cells/") + name; }

void write_metadata(hdf5::File& file, const RunMetadata& metadata) {
  file.set_attribute("/", "format", "corpuscle run 1");
  file.set_attribute("/", "scene", metadata.scene);
  file.set_attribute("/", "version", metadata.version);
  file.set_attribute("/", "git_revision", metadata.git_revision);
  file.set_attribute("/", "cpu_model", metadata.cpu_model);
  file.set_attribute("/", "cores", metadata.cores);
  file.set_attribute("/", "operating_system", metadata.operating_system);
  file.set_attribute("/", "kokkos_configuration", metadata.kokkos_configuration);
}

void write_cell_type(hdf5::File& file, const std::string& group, const CellTypeLattice& type) {
  file.create_group(group);
  file.set_attribute(group, "name", type.name);
  file.set_attribute(group, "law", type.moduli.law == StrainLawKind::skalak ? "skalak" : "neo_hookean");
  for (const auto& [name, value] : named_integers(type)) file.set_attribute(group, name, value);
  for (const auto& [name, value] : named_numbers(type)) file.set_attribute(group, name, value);
}

void write_lattice(hdf5::File& file, const LatticeParameters& lattice) {
  file.create_group("/lattice");
  const auto integer = [&](const char* name, std::int64_t value) { file.set_attribute("/lattice", name, value); };
  const std::vector<std::int64_t> nodes(lattice.nodes.begin(), lattice.nodes.end());
  file.set_attribute("/lattice", "nodes", std::span<const std::int64_t>(nodes));
  for (const auto& [name, value] : named_numbers(lattice)) file.set_attribute("/lattice", name, value);
  integer("steps", lattice.steps);
  integer("series_every", lattice.series_every);
  integer("snapshot_every", lattice.snapshot_every);
  integer("coupling_every", lattice.coupling_every);
  for (std::size_t i = 0; i < lattice.limits.size(); ++i) {
    const auto group = fmt::format("/lattice/limits/{}", i);
    file.create_group(group);
    file.set_attribute(group, "name", lattice.limits[i].name);
    file.set_attribute(group, "shear_rate", lattice.limits[i].shear_rate);
  }
  for (std::size_t i = 0; i < lattice.cells.size(); ++i) write_cell_type(file, fmt::format("/lattice/cell_types/{}", i), lattice.cells[i]);
}

void create_cell_datasets(hdf5::File& file, const LatticeParameters& lattice) {
  std::vector<std::int32_t> types;
  std::vector<std::string> names;
  for (const auto& type : lattice.cells) {
    types.insert(types.end(), static_cast<std::size_t>(type.count), static_cast<std::int32_t>(names.size()));
    names.push_back(type.name);
  }
  file.create_group("/cells");
  file.write<std::int32_t>("/cells/type", types, {types.size()});
  file.set_attribute("/cells/type", "description", "number of the cell's type in type_names");
  file.set_attribute("/cells/type", "unit", "1");
  file.write_strings("/cells/type_names", names);
  file.set_attribute("/cells/type_names", "description", "name of each cell type, as in the scene");
  file.set_attribute("/cells/type_names", "unit", "1");
  for (const auto& quantity : cell_quantities()) {
    hdf5::RowLayout layout{.row_shape = quantity.shape, .unit = quantity.unit, .description = quantity.description};
    layout.row_shape.insert(layout.row_shape.begin(), types.size());
    file.create_rows<double>(in_cells(quantity.name), layout);
  }
}

}  // namespace

RunFile::RunFile(std::filesystem::path path, RunFileOptions options)
    : path_(std::move(path)),
      options_(options),
      series_(series_quantities().size()),
      cells_(cell_quantities().size()),
      last_flush_(std::chrono::steady_clock::now()) {}

RunFile::RunFile(std::filesystem::path path, const RunMetadata& metadata, const LatticeParameters& lattice, RunFileOptions options)
    : RunFile(std::move(path), options) {
  auto file = hdf5::File::create(path_);
  write_metadata(file, metadata);
  write_lattice(file, lattice);
  file.create_rows<std::int64_t>("/series/step", {.unit = "dt", .description = "time step"});
  for (const auto& quantity : series_quantities()) {
    file.create_rows<double>(in_series(quantity.name), {.row_shape = quantity.shape, .unit = quantity.unit, .description = quantity.description});
  }
  for (const auto& type : lattice.cells) cell_count_ += static_cast<std::size_t>(type.count);
  options_.trajectories = options_.trajectories && cell_count_ > 0;
  if (options_.trajectories) create_cell_datasets(file, lattice);
  file.close();
}

RunFile RunFile::resume(std::filesystem::path path, std::int64_t step, RunFileOptions options) {
  RunFile run(std::move(path), options);
  auto file = hdf5::File::open_for_append(run.path_);
  const auto steps = file.read<std::int64_t>("/series/step").values;
  const auto kept = static_cast<std::size_t>(std::upper_bound(steps.begin(), steps.end(), step) - steps.begin());
  run.options_.trajectories = file.exists("/cells");
  if (run.options_.trajectories) run.cell_count_ = file.shape("/cells/type").at(0);
  run.rows_written_ = kept;
  run.add_missing(file);
  run.cut(file);
  file.close();
  return run;
}

RunFile::~RunFile() {
  try {
    flush();
  } catch (...) {  // NOLINT: a destructor can't report; whoever needs to know calls flush() first
  }
}

void RunFile::append(const Sample& sample) {
  if (options_.trajectories && sample.cells.size() != cell_count_) throw std::logic_error("RunFile::append: the sample doesn't hold every cell");
  Sample& readable = const_cast<Sample&>(sample);  // the table's accessors also serve reading; nothing is changed here
  steps_.push_back(sample.step);
  for (std::size_t i = 0; i < series_.size(); ++i) {
    const auto& quantity = series_quantities()[i];
    const double* values = quantity.values(readable);
    series_[i].insert(series_[i].end(), values, values + size_of(quantity.shape));
    waiting_bytes_ += size_of(quantity.shape) * sizeof(double);
  }
  for (std::size_t i = 0; options_.trajectories && i < cells_.size(); ++i) {
    const auto& quantity = cell_quantities()[i];
    for (const auto& cell : sample.cells) {
      const double* values = quantity.values(cell);
      cells_[i].insert(cells_[i].end(), values, values + size_of(quantity.shape));
    }
    waiting_bytes_ += size_of(quantity.shape) * sizeof(double) * cell_count_;
  }
  if (waiting_bytes_ >= options_.buffer_bytes || std::chrono::steady_clock::now() - last_flush_ >= options_.flush_every) flush();
}

void RunFile::set_length(const std::string& scene, std::int64_t steps) {
  auto file = hdf5::File::open_for_append(path_);
  file.set_attribute("/", "scene", scene);
  file.set_attribute("/lattice", "steps", steps);
  file.close();
}

void RunFile::add_missing(hdf5::File& file) const {
  const auto add = [&](const std::string& name, const char* unit, const char* description, const hdf5::Shape& row) {
    if (file.exists(name)) return;
    file.create_rows<double>(name, {.row_shape = row, .unit = unit, .description = description});
    file.append<double>(name, std::vector<double>(rows_written_ * size_of(row), std::numeric_limits<double>::quiet_NaN()));
  };
  for (const auto& quantity : series_quantities()) add(in_series(quantity.name), quantity.unit, quantity.description, quantity.shape);
  for (const auto& quantity : cell_quantities()) {
    if (!options_.trajectories) break;
    hdf5::Shape row = quantity.shape;
    row.insert(row.begin(), cell_count_);
    add(in_cells(quantity.name), quantity.unit, quantity.description, row);
  }
}

void RunFile::cut(hdf5::File& file) const {
  file.set_row_count("/series/step", rows_written_);
  for (const auto& quantity : series_quantities()) file.set_row_count(in_series(quantity.name), rows_written_);
  if (!options_.trajectories) return;
  for (const auto& quantity : cell_quantities()) file.set_row_count(in_cells(quantity.name), rows_written_);
}

void RunFile::flush() {
  last_flush_ = std::chrono::steady_clock::now();
  if (steps_.empty()) return;
  auto file = hdf5::File::open_for_append(path_);
  file.append<std::int64_t>("/series/step", steps_);
  for (std::size_t i = 0; i < series_.size(); ++i) file.append<double>(in_series(series_quantities()[i].name), series_[i]);
  if (options_.trajectories) {
    for (std::size_t i = 0; i < cells_.size(); ++i) file.append<double>(in_cells(cell_quantities()[i].name), cells_[i]);
  }
  file.close();
  rows_written_ += steps_.size();
  steps_.clear();
  for (auto& rows : series_) rows.clear();
  for (auto& rows : cells_) rows.clear();
  waiting_bytes_ = 0;
}

std::vector<std::string> run_file_rows(bool trajectories) {
  std::vector<std::string> names{"/series/step"};
  for (const auto& quantity : series_quantities()) names.push_back(in_series(quantity.name));
  if (trajectories)
    for (const auto& quantity : cell_quantities()) names.push_back(in_cells(quantity.name));
  return names;
}

std::vector<Sample> read_series(const std::filesystem::path& path) {
  const auto file = hdf5::File::open_for_reading(path);
  const auto steps = file.read<std::int64_t>("/series/step").values;
  std::vector<Sample> samples(steps.size());
  for (std::size_t row = 0; row < samples.size(); ++row) samples[row].step = steps[row];
  for (const auto& quantity : series_quantities()) {
    const auto data = file.read<double>(in_series(quantity.name)).values;
    const std::size_t size = size_of(quantity.shape);
    // A file caught in the middle of a flush may have series of different lengths.
    samples.resize(std::min(samples.size(), data.size() / size));
    for (std::size_t row = 0; row < samples.size(); ++row) std::copy_n(&data[row * size], size, quantity.values(samples[row]));
  }
  return samples;
}

}  // namespace corpuscle
