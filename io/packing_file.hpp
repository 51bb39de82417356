// A saved packing: the vertices of all cells, so that later runs can start without packing again (scene key run.packing).
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "physics/units.hpp"

namespace corpuscle {

/// What must agree between a packing and the scene that starts from it.
struct PackedType {
  std::string name;
  double radius = 0;          ///< lattice units
  std::int64_t vertices = 0;  ///< per cell
  std::int64_t count = 0;
};

struct Packing {
  std::array<double, 3> box{};     ///< lattice units
  std::vector<PackedType> types;
  std::vector<double> positions;   ///< [vertices][3], lattice units, ordered by type, cell, vertex
};

/// Box and types of a scene, without positions.
Packing packing_layout(const LatticeParameters& lattice);

/// Writes the packing: to a temporary name first. @throws OutputError; std::logic_error when the positions don't match the types.
void save_packing(const std::filesystem::path& path, const Packing& packing);

/// Reads a packing and checks it against `expected` (its positions don't matter).
/// @throws InputError when the file is missing, isn't a packing, or differs: the message names what, both values, and the way out.
Packing load_packing(const std::filesystem::path& path, const Packing& expected);

}  // namespace corpuscle
