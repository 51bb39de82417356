// Layout: docs.vtk.org, "VTKHDF format specification". Data of all steps lie end to end; the group Steps says where each step begins.
#include "io/vtkhdf.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "io/hdf5.hpp"
#include "physics/statistics/ellipsoid.hpp"
#include "physics/statistics/volume_moments.hpp"

namespace corpuscle {
namespace {

constexpr std::array<const char*, 4> topologies{"Vertices", "Lines", "Polygons", "Strips"};
constexpr std::int64_t format_version[] = {2, 0};

double time_of(const VtkDomain& domain, std::int64_t step, double strain) { return domain.at_rest ? static_cast<double>(step) : strain; }

void create_root(hdf5::File& file, const char* type, const VtkDomain& domain) {
  file.create_group("/VTKHDF");
  file.set_attribute("/VTKHDF", "Version", std::span<const std::int64_t>(format_version));
  file.set_ascii_attribute("/VTKHDF", "Type", type);
  file.create_group("/VTKHDF/Steps");
  file.set_attribute("/VTKHDF/Steps", "NSteps", std::int64_t{0});
  file.create_rows<double>("/VTKHDF/Steps/Values", {.description = domain.at_rest ? "time step" : "strain"});
  // Not part of VTKHDF (readers ignore other groups): what a script needs beside the surfaces.
  file.create_group("/corpuscle");
  file.set_attribute("/corpuscle", "box", std::span<const double>(domain.size));
  file.set_attribute("/corpuscle", "radius", domain.radius);
  file.set_attribute("/corpuscle", "walls", std::int64_t{domain.periodic[2] ? 0 : 1});
}

void create_offsets(hdf5::File& file, const std::string& name, std::size_t columns) {
  file.create_rows<std::int64_t>("/VTKHDF/Steps/" + name, {.row_shape = columns > 0 ? hdf5::Shape{columns} : hdf5::Shape{}});
}

void append_number(hdf5::File& file, const std::string& name, std::int64_t value) {
  file.append<std::int64_t>(name, std::span<const std::int64_t>(&value, 1));
}

// NSteps is what readers trust, so it's written last, when everything it counts is there.
void finish_step(hdf5::File& file, std::size_t steps, double time) {
  file.append<double>("/VTKHDF/Steps/Values", std::span<const double>(&time, 1));
  file.set_attribute("/VTKHDF/Steps", "NSteps", static_cast<std::int64_t>(steps + 1));
  file.close();
}

std::size_t step_count(const hdf5::File& file) { return static_cast<std::size_t>(file.number_attribute("/VTKHDF/Steps", "NSteps")); }

std::size_t steps_until(const hdf5::File& file, double time) {
  const auto times = file.read<double>("/VTKHDF/Steps/Values").values;
  const double tolerance = 1e-9 * std::max(std::abs(time), 1.0);
  return std::min(step_count(file), static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), time + tolerance) - times.begin()));
}

// A write that failed half-way leaves rows that no step counts; the next one starts over them.
void cut(hdf5::File& file, const std::string& name, std::size_t rows) {
  if (file.shape(name).at(0) != rows) file.set_row_count(name, rows);
}

}  // namespace

VtkHdfPolyData::VtkHdfPolyData(std::filesystem::path path, std::vector<VtkCellType> types, const VtkDomain& domain)
    : path_(std::move(path)), types_(std::move(types)), domain_(domain) {
  for (const auto& type : types_) {
    surface_.points += type.count * type.vertices;
    surface_.faces += type.count * static_cast<std::int64_t>(type.faces.size());
  }
  create();
}

void VtkHdfPolyData::create() {
  std::vector<std::int32_t> connectivity, cell_id, type_number;
  std::vector<std::string> names;
  std::int32_t first_vertex = 0;
  std::int32_t cell = 0;
  for (const auto& type : types_) {
    for (std::int64_t i = 0; i < type.count; ++i, ++cell) {
      for (const auto& face : type.faces) {
        for (const int vertex : face) connectivity.push_back(first_vertex + vertex);
      }
      cell_id.insert(cell_id.end(), static_cast<std::size_t>(type.vertices), cell);
      type_number.insert(type_number.end(), static_cast<std::size_t>(type.vertices), static_cast<std::int32_t>(names.size()));
      first_vertex += static_cast<std::int32_t>(type.vertices);
    }
    names.push_back(type.name);
  }
  std::vector<std::int32_t> offsets;
  for (std::int64_t face = 0; face <= surface_.faces; ++face) offsets.push_back(static_cast<std::int32_t>(3 * face));

  auto file = hdf5::File::create(path_);
  create_root(file, "PolyData", domain_);
  file.write_strings("/corpuscle/type_names", names);
  // All steps share one part, which describes the topology; only the points move on. (With a part per step, VTK 9.3 doesn't find the
  // beginning of topology that is shared by the steps.)
  file.write<std::int64_t>("/VTKHDF/NumberOfPoints", std::span(&surface_.points, 1), {1});
  file.create_rows<float>("/VTKHDF/Points", {.row_shape = {3}, .chunk_rows = 8192});
  for (const std::string topology : topologies) {
    const std::string group = "/VTKHDF/" + topology;
    const bool used = topology == "Polygons";
    const std::array<std::int64_t, 2> counts{used ? surface_.faces : 0, used ? 3 * surface_.faces : 0};
    file.write<std::int64_t>(group + "/NumberOfCells", std::span(counts).first(1), {1});
    file.write<std::int64_t>(group + "/NumberOfConnectivityIds", std::span(counts).last(1), {1});
    const auto used_connectivity = std::span<const std::int32_t>(connectivity).first(used ? connectivity.size() : 0);
    const auto used_offsets = std::span<const std::int32_t>(offsets).first(used ? offsets.size() : 1);
    file.write<std::int32_t>(group + "/Connectivity", used_connectivity, {used_connectivity.size()});
    file.write<std::int32_t>(group + "/Offsets", used_offsets, {used_offsets.size()});
  }
  file.write<std::int32_t>("/VTKHDF/PointData/cell_id", cell_id, {cell_id.size()});
  file.write<std::int32_t>("/VTKHDF/PointData/type", type_number, {type_number.size()});
  file.create_rows<float>("/VTKHDF/PointData/velocity", {.row_shape = {3}, .unit = "dx/dt", .chunk_rows = 8192});
  file.create_rows<float>("/VTKHDF/PointData/deformation", {.unit = "1", .chunk_rows = 8192});
  for (const char* name : {"PartOffsets", "NumberOfParts", "PointOffsets"}) create_offsets(file, name, 0);
  for (const char* name : {"CellOffsets", "ConnectivityIdOffsets"}) create_offsets(file, name, topologies.size());
  for (const char* name : {"cell_id", "type", "velocity", "deformation"}) create_offsets(file, std::string("PointDataOffsets/") + name, 0);
  file.close();
}

void VtkHdfPolyData::append(const Snapshot& snapshot) {
  const auto points = static_cast<std::size_t>(surface_.points);
  if (snapshot.positions.size() != 3 * points || snapshot.velocities.size() != 3 * points) {
    throw std::logic_error("VtkHdfPolyData::append: the snapshot doesn't hold every vertex");
  }
  std::vector<float> positions(3 * points);
  std::vector<float> deformation(points);
  const std::vector<float> velocities(snapshot.velocities.begin(), snapshot.velocities.end());
  std::size_t first = 0;
  for (const auto& type : types_) {
    const auto vertices = static_cast<std::size_t>(type.vertices);
    for (std::int64_t cell = 0; cell < type.count; ++cell, first += vertices) {
      const auto moments = statistics::volume_moments(std::span(snapshot.positions).subspan(3 * first, 3 * vertices), type.faces);
      std::array<double, 3> shift{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (domain_.periodic[axis]) shift[axis] = -domain_.size[axis] * std::floor(moments.centre[axis] / domain_.size[axis]);
      }
      for (std::size_t i = 3 * first; i < 3 * (first + vertices); ++i) positions[i] = static_cast<float>(snapshot.positions[i] + shift[i % 3]);
      std::fill_n(&deformation[first], vertices, static_cast<float>(statistics::fit_ellipsoid(moments.gyration).deformation));
    }
  }

  auto file = hdf5::File::open_for_append(path_);
  const std::size_t step = step_count(file);
  for (const char* name : {"Points", "PointData/velocity", "PointData/deformation"}) cut(file, std::string("/VTKHDF/") + name, step * points);
  for (const char* name : {"Steps/Values", "Steps/PartOffsets", "Steps/NumberOfParts", "Steps/PointOffsets", "Steps/CellOffsets",
                           "Steps/ConnectivityIdOffsets", "Steps/PointDataOffsets/cell_id", "Steps/PointDataOffsets/type",
                           "Steps/PointDataOffsets/velocity", "Steps/PointDataOffsets/deformation"}) {
    cut(file, std::string("/VTKHDF/") + name, step);
  }
  file.append<float>("/VTKHDF/Points", positions);
  file.append<float>("/VTKHDF/PointData/velocity", velocities);
  file.append<float>("/VTKHDF/PointData/deformation", deformation);
  const auto first_point = static_cast<std::int64_t>(step * points);
  const std::array<std::int64_t, 4> start_again{};  // the topology never changes: every step reads it from its beginning
  append_number(file, "/VTKHDF/Steps/PartOffsets", 0);
  append_number(file, "/VTKHDF/Steps/NumberOfParts", 1);
  append_number(file, "/VTKHDF/Steps/PointOffsets", first_point);
  file.append<std::int64_t>("/VTKHDF/Steps/CellOffsets", start_again);
  file.append<std::int64_t>("/VTKHDF/Steps/ConnectivityIdOffsets", start_again);
  for (const char* name : {"cell_id", "type"}) append_number(file, std::string("/VTKHDF/Steps/PointDataOffsets/") + name, 0);
  for (const char* name : {"velocity", "deformation"}) append_number(file, std::string("/VTKHDF/Steps/PointDataOffsets/") + name, first_point);
  finish_step(file, step, time_of(domain_, snapshot.step, snapshot.strain));
}

VtkHdfPolyData VtkHdfPolyData::resume(std::filesystem::path path, std::vector<VtkCellType> types, const VtkDomain& domain, std::int64_t step,
                                      double strain) {
  VtkHdfPolyData result;
  result.path_ = std::move(path);
  result.types_ = std::move(types);
  result.domain_ = domain;
  for (const auto& type : result.types_) {
    result.surface_.points += type.count * type.vertices;
    result.surface_.faces += type.count * static_cast<std::int64_t>(type.faces.size());
  }
  auto file = hdf5::File::open_for_append(result.path_);
  // Rows beyond NSteps are cut by the next append.
  file.set_attribute("/VTKHDF/Steps", "NSteps", static_cast<std::int64_t>(steps_until(file, time_of(domain, step, strain))));
  file.close();
  return result;
}

std::size_t VtkHdfPolyData::snapshots() const { return step_count(hdf5::File::open_for_reading(path_)); }
std::size_t VtkHdfImage::snapshots() const { return step_count(hdf5::File::open_for_reading(path_)); }

VtkHdfImage::VtkHdfImage(std::filesystem::path path, std::array<int, 3> nodes, const VtkDomain& domain)
    : path_(std::move(path)), nodes_(nodes), domain_(domain) {
  const std::array<std::int64_t, 6> extent{0, nodes[0] - 1, 0, nodes[1] - 1, 0, nodes[2] - 1};
  const std::array<double, 3> origin{0.5, 0.5, 0.5};
  const std::array<double, 3> spacing{1, 1, 1};
  const std::array<double, 9> direction{1, 0, 0, 0, 1, 0, 0, 0, 1};
  auto file = hdf5::File::create(path_);
  create_root(file, "ImageData", domain_);
  file.set_attribute("/VTKHDF", "WholeExtent", std::span<const std::int64_t>(extent));
  file.set_attribute("/VTKHDF", "Origin", std::span<const double>(origin));
  file.set_attribute("/VTKHDF", "Spacing", std::span<const double>(spacing));
  file.set_attribute("/VTKHDF", "Direction", std::span<const double>(direction));
  const hdf5::Shape row{static_cast<std::size_t>(nodes[2]), static_cast<std::size_t>(nodes[1]), static_cast<std::size_t>(nodes[0]), 3};
  file.create_rows<float>("/VTKHDF/PointData/velocity", {.row_shape = row, .unit = "dx/dt", .chunk_rows = 1});
  create_offsets(file, "PointDataOffsets/velocity", 0);
  file.close();
}

VtkHdfImage VtkHdfImage::resume(std::filesystem::path path, std::array<int, 3> nodes, const VtkDomain& domain, std::int64_t step, double strain) {
  VtkHdfImage result;
  result.path_ = std::move(path);
  result.nodes_ = nodes;
  result.domain_ = domain;
  auto file = hdf5::File::open_for_append(result.path_);
  file.set_attribute("/VTKHDF/Steps", "NSteps", static_cast<std::int64_t>(steps_until(file, time_of(domain, step, strain))));
  file.close();
  return result;
}

void VtkHdfImage::append(const Snapshot& snapshot) {
  std::size_t values = 3;
  for (const int n : nodes_) values *= static_cast<std::size_t>(n);
  if (snapshot.fluid_velocity.size() != values) throw std::logic_error("VtkHdfImage::append: the snapshot doesn't hold the fluid velocity");
  auto file = hdf5::File::open_for_append(path_);
  const std::size_t step = step_count(file);
  for (const char* name : {"PointData/velocity", "Steps/Values", "Steps/PointDataOffsets/velocity"}) cut(file, std::string("/VTKHDF/") + name, step);
  file.append<float>("/VTKHDF/PointData/velocity", snapshot.fluid_velocity);
  append_number(file, "/VTKHDF/Steps/PointDataOffsets/velocity", static_cast<std::int64_t>(step));
  finish_step(file, step, time_of(domain_, snapshot.step, snapshot.strain));
}

}  // namespace corpuscle
