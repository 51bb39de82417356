#include "physics/suspension_sample.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "physics/statistics/ellipsoid.hpp"

namespace corpuscle {

void average_over_cells(Sample& sample, const std::vector<CellType>& types, const LatticeParameters& lattice, bool walls) {
  const double box = lattice.box_volume();
  const double height = lattice.nodes[2];
  const double layer = wall_layer(lattice, walls);
  const double bulk = box * (height - 2 * layer) / height;
  for (std::size_t t = 0; t < types.size(); ++t) {
    const CellType& type = types[t];
    const double volume = lattice.cells[t].volume, area = lattice.cells[t].area;
    for (int c = type.first_cell; c < type.first_cell + type.count; ++c) {
      const auto& cell = sample.cells[c];
      const bool in_bulk = layer == 0 || (cell.centre[2] >= layer && cell.centre[2] <= height - layer);
      for (int k = 0; k < 9; ++k) {
        sample.particle_stress[k] += cell.stresslet[k] / box;
        if (in_bulk) sample.bulk_particle_stress[k] += cell.stresslet[k] / bulk;
      }
      sample.volume_drift_max = std::max(sample.volume_drift_max, std::abs(cell.volume / volume - 1));
      sample.area_drift_max = std::max(sample.area_drift_max, std::abs(cell.area / area - 1));
      sample.mean_deformation += statistics::fit_ellipsoid(cell.gyration).deformation / double(sample.cells.size());
    }
  }
  // Rows and columns of the stress: 0 = x (flow), 1 = y (vorticity), 2 = z (gradient).
  const double unit = lattice.viscosity * lattice.shear_rate;
  const double none = std::numeric_limits<double>::quiet_NaN();
  const auto& s = sample.particle_stress;
  sample.relative_viscosity = unit > 0 ? 1 + s[2] / unit : none;
  sample.bulk_relative_viscosity = unit > 0 ? 1 + sample.bulk_particle_stress[2] / unit : none;
  sample.normal_stress_difference_1 = unit > 0 ? (s[0] - s[8]) / unit : none;
  sample.normal_stress_difference_2 = unit > 0 ? (s[8] - s[4]) / unit : none;
  sample.particle_pressure = unit > 0 ? -(s[0] + s[4] + s[8]) / (3 * unit) : none;
}

}  // namespace corpuscle
