// What an analysis starts from: the numbers of a run and its series, in memory or read from a file piece by piece. Lattice units unless stated otherwise.
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace corpuscle::analysis {

/// What is known of each cell at each sample (CellSample of physics/sample.hpp).
enum class CellQuantity {
  centre,     ///< 3 numbers, unwrapped
  velocity,   ///< 3
  gyration,   ///< 6: xx yy zz xy xz yz
  stresslet,  ///< 9: row force, column position
  volume,     ///< 1
};

constexpr int components_of(CellQuantity quantity) {
  switch (quantity) {
    case CellQuantity::centre:
    case CellQuantity::velocity: return 3;
    case CellQuantity::gyration: return 6;
    case CellQuantity::stresslet: return 9;
    case CellQuantity::volume: break;
  }
  return 1;
}

/// Trajectories of all cells over an even grid of times. They may be larger than the memory: whoever needs them visits one quantity and keeps what it needs.
class CellSeries {
 public:
  /// Number of the time on the grid, and that sample's values [cells][components].
  using Visitor = std::function<void(Eigen::Index time, std::span<const double> values)>;

  virtual ~CellSeries() = default;
  virtual Eigen::Index cells() const = 0;
  /// All samples from time `first` on, in order. Times without a sample are left out.
  virtual void visit(CellQuantity quantity, Eigen::Index first, const Visitor& visitor) const = 0;

  /// One component of the times [first, first + times) as [times][cells], NaN where there is no sample.
  Eigen::MatrixXd component(CellQuantity quantity, int component, Eigen::Index first, Eigen::Index times) const;
};

enum class FlowOf { shear, poiseuille, rest };

/// Cells of one type; volumes per cell.
struct CellTypeRecord {
  std::string name;
  Eigen::Index count = 0;
  double effective_radius = 0;
  double volume = 0;            ///< of the mesh
  double effective_volume = 0;  ///< with the shell
};

/// Series lie on an even grid of times, NaN where there is no sample.
struct RunRecord {
  std::string directory;
  FlowOf flow = FlowOf::shear;
  bool walls = true;
  double capillary_number = 0, phi_geometric = 0, phi_nominal = 0, phi_effective = 0;  ///< nominal: of the cells at their nominal size
  double radius = 0, viscosity = 0, shear_rate = 0;
  std::array<double, 3> box{};
  double rate_factor = 1;    ///< `shear_rate` over the one that the walls impose (referred_to)
  double interval = 0;       ///< strain between two times of the grid; NaN at rest
  double strain = 0;         ///< of the last sample
  std::int64_t samples = 0;  ///< in the file
  std::vector<CellTypeRecord> types;
  std::vector<std::int32_t> type_of_cell;

  std::vector<double> relative_viscosity, wall_relative_viscosity, mean_deformation, volume_drift_max, area_drift_max;
  /// Stress of the cells more than 4 radii away from the walls: xx, yy, zz, xz.
  std::array<std::vector<double>, 4> bulk_stress;
  std::shared_ptr<const CellSeries> cells;  ///< null: the run wrote no trajectories
  std::vector<std::string> warnings;        ///< of the reading

  Eigen::Index times() const { return static_cast<Eigen::Index>(relative_viscosity.size()); }
  Eigen::Index cell_count() const;
  double mean_effective_radius() const;  ///< over the cells; NaN without
};

/// The same run with `factor` times its shear rate as the unit of rates: capillary number, strains and viscosities change with it.
RunRecord referred_to(double factor, RunRecord record);

}  // namespace corpuscle::analysis
