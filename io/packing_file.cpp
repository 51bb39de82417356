#include "io/packing_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <system_error>

#include "core/error.hpp"
#include "io/hdf5.hpp"

namespace corpuscle {
namespace {

constexpr const char* format_name = "corpuscle packing 1";

std::int64_t vertex_count(const Packing& packing) {
  std::int64_t n = 0;
  for (const auto& type : packing.types) n += type.count * type.vertices;
  return n;
}

Packing read_packing(const std::filesystem::path& path) {
  const auto file = hdf5::File::open_for_reading(path);
  if (file.string_attribute("/", "format") != format_name) throw OutputError(path.string() + ": unknown format");
  Packing packing;
  const auto box = file.numbers_attribute("/", "box");
  for (std::size_t axis = 0; axis < 3; ++axis) packing.box[axis] = box.at(axis);
  const auto names = file.read_strings("/type_names");
  const auto radii = file.read<double>("/radius").values;
  const auto vertices = file.read<std::int64_t>("/vertices").values;
  const auto counts = file.read<std::int64_t>("/count").values;
  for (std::size_t i = 0; i < names.size(); ++i) packing.types.push_back({names[i], radii.at(i), vertices.at(i), counts.at(i)});
  packing.positions = file.read<double>("/positions").values;
  return packing;
}

bool close(double a, double b) { return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b)); }

}  // namespace

Packing packing_layout(const LatticeParameters& lattice) {
  Packing packing;
  for (std::size_t axis = 0; axis < 3; ++axis) packing.box[axis] = lattice.nodes[axis];
  for (const auto& type : lattice.cells) packing.types.push_back({type.name, type.mesh_radius, type.vertices, type.count});
  return packing;
}

void save_packing(const std::filesystem::path& path, const Packing& packing) {
  const auto vertices = static_cast<std::size_t>(vertex_count(packing));
  if (packing.positions.size() != 3 * vertices) throw std::logic_error("save_packing: the positions don't match the cell types");
  std::vector<std::string> names;
  std::vector<double> radii;
  std::vector<std::int64_t> per_cell, counts;
  for (const auto& type : packing.types) {
    names.push_back(type.name);
    radii.push_back(type.radius);
    per_cell.push_back(type.vertices);
    counts.push_back(type.count);
  }
  auto temporary = path;
  temporary += ".tmp";
  try {
    auto file = hdf5::File::create(temporary);
    file.set_attribute("/", "format", format_name);
    file.set_attribute("/", "box", std::span<const double>(packing.box));
    file.write_strings("/type_names", names);
    file.write<double>("/radius", radii, {radii.size()});
    file.write<std::int64_t>("/vertices", per_cell, {per_cell.size()});
    file.write<std::int64_t>("/count", counts, {counts.size()});
    file.write<double>("/positions", packing.positions, {vertices, 3});
    file.set_attribute("/positions", "unit", "dx");
    file.close();
    std::filesystem::rename(temporary, path);
  } catch (const std::filesystem::filesystem_error& error) {
    throw OutputError(fmt::format("{}: saving the packing failed: {}", path.string(), error.code().message()));
  } catch (const OutputError&) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw;
  }
}

Packing load_packing(const std::filesystem::path& path, const Packing& expected) {
  Packing packing;
  try {
    packing = read_packing(path);
  } catch (const std::exception& error) {
    throw InputError(fmt::format("run.packing: can't read a packing from {}. It must be a file that `corpuscle` saved as a packing; leave the key "
                                 "out to pack anew. ({})",
                                 path.string(), error.what()));
  }
  const auto differ = [&](const std::string& what, const auto& saved, const auto& wanted) {
    throw InputError(fmt::format("run.packing: {} doesn't fit this scene: {} is {} in the packing and {} in the scene. Make both equal, or leave "
                                 "the key out to pack anew.",
                                 path.string(), what, saved, wanted));
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!close(packing.box[axis], expected.box[axis])) {
      differ(fmt::format("the box length along {} (lattice nodes)", "xyz"[axis]), packing.box[axis], expected.box[axis]);
    }
  }
  if (packing.types.size() != expected.types.size()) differ("the number of cell types", packing.types.size(), expected.types.size());
  for (std::size_t i = 0; i < packing.types.size(); ++i) {
    const auto& saved = packing.types[i];
    const auto& wanted = expected.types[i];
    if (saved.name != wanted.name) differ(fmt::format("the name of cell type {}", i + 1), saved.name, wanted.name);
    const std::string of = " of cell type '" + wanted.name + "'";
    if (saved.count != wanted.count) differ("the number of cells" + of, saved.count, wanted.count);
    if (saved.vertices != wanted.vertices) differ("the number of vertices per cell" + of, saved.vertices, wanted.vertices);
    if (!close(saved.radius, wanted.radius)) differ("the radius (lattice units)" + of, saved.radius, wanted.radius);
  }
  if (packing.positions.size() != 3 * static_cast<std::size_t>(vertex_count(expected))) {
    differ("the number of coordinates", packing.positions.size(), 3 * vertex_count(expected));
  }
  return packing;
}

}  // namespace corpuscle
