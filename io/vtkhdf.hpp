// Snapshots for ParaView and VTK in the VTKHDF 2.0 format: the cells' surfaces (PolyData) and the fluid (ImageData), all steps in one file.
// Lengths are lattice units. The time of a step is its strain, or its step number at rest.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "physics/sample.hpp"

namespace corpuscle {

/// One cell type: the reference mesh's faces are shared by all its cells.
struct VtkCellType {
  std::string name;
  std::vector<std::array<int, 3>> faces;  ///< outward triangles
  std::int64_t vertices = 0;              ///< per cell
  std::int64_t count = 0;
};

/// The box that snapshots are shown in.
struct VtkDomain {
  std::array<double, 3> size{};                     ///< lattice units
  std::array<bool, 3> periodic{true, true, false};  ///< false along z between walls
  double radius = 1;                                ///< r, lattice units
  bool at_rest = false;                             ///< the time axis is the step number instead of the strain
};

/// Writes cells.vtkhdf. Every cell is shown whole, shifted by box lengths so that its centre lies in the box.
/// Point data: velocity, deformation, cell_id, type. The file is closed between snapshots: readable and complete at any time.
/// All functions throw OutputError when the file can't be written.
class VtkHdfPolyData {
 public:
  /// Creates the file, replacing an older one. Types come in the order of Snapshot.
  VtkHdfPolyData(std::filesystem::path path, std::vector<VtkCellType> types, const VtkDomain& domain);
  /// Continues an interrupted run's file: snapshots with a time beyond that of `step`/`strain` are cut off.
  static VtkHdfPolyData resume(std::filesystem::path path, std::vector<VtkCellType> types, const VtkDomain& domain, std::int64_t step, double strain);

  /// Snapshots in the file.
  std::size_t snapshots() const;
  /// Writes one snapshot. `snapshot.positions` and `.velocities` hold every vertex.
  void append(const Snapshot& snapshot);

 private:
  struct Surface {  ///< static topology of all cells together
    std::int64_t points = 0;
    std::int64_t faces = 0;
  };
  VtkHdfPolyData() = default;
  void create();

  std::filesystem::path path_;
  std::vector<VtkCellType> types_;
  VtkDomain domain_;
  Surface surface_;
};

/// Writes fluid.vtkhdf: point data velocity at the fluid nodes, which lie at (i + 1/2) lattice spacings from the box's corner.
class VtkHdfImage {
 public:
  VtkHdfImage(std::filesystem::path path, std::array<int, 3> nodes, const VtkDomain& domain);
  static VtkHdfImage resume(std::filesystem::path path, std::array<int, 3> nodes, const VtkDomain& domain, std::int64_t step, double strain);

  std::size_t snapshots() const;
  /// Writes `snapshot.fluid_velocity` [nz][ny][nx][3].
  void append(const Snapshot& snapshot);

 private:
  VtkHdfImage() = default;

  std::filesystem::path path_;
  std::array<int, 3> nodes_{};
  VtkDomain domain_;
};

}  // namespace corpuscle
