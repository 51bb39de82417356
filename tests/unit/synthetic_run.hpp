// A run in memory whose observables are known: cells with prescribed velocities, stresslets and shapes.
#pragma once
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "physics/analysis/record.hpp"
#include "tests/unit/synthetic_series.hpp"

namespace corpuscle::test {

/// Trajectories in memory, [times][cells][components].
class MemoryCells : public analysis::CellSeries {
 public:
  MemoryCells(Eigen::Index times, Eigen::Index cells) : times_(times), cells_(cells) {
    for (std::size_t q = 0; q < values_.size(); ++q) values_[q].assign(static_cast<std::size_t>(times * cells * width(static_cast<analysis::CellQuantity>(q))), 0);
  }
  double& at(analysis::CellQuantity quantity, Eigen::Index time, Eigen::Index cell, int component) {
    return values_[static_cast<std::size_t>(quantity)][static_cast<std::size_t>((time * cells_ + cell) * width(quantity) + component)];
  }
  Eigen::Index cells() const override { return cells_; }
  void visit(analysis::CellQuantity quantity, Eigen::Index first, const Visitor& visitor) const override {
    const auto row = static_cast<std::size_t>(cells_ * width(quantity));
    for (Eigen::Index t = first; t < times_; ++t)
      if (!missing(t)) visitor(t, std::span(values_[static_cast<std::size_t>(quantity)]).subspan(static_cast<std::size_t>(t) * row, row));
  }
  /// Takes times out, as a gap in a file does.
  void remove(Eigen::Index from, Eigen::Index to) { gap_from_ = from, gap_to_ = to; }

 private:
  static Eigen::Index width(analysis::CellQuantity quantity) { return components_of(quantity); }
  bool missing(Eigen::Index t) const { return t >= gap_from_ && t < gap_to_; }
  Eigen::Index times_, cells_, gap_from_ = 0, gap_to_ = 0;
  std::array<std::vector<double>, 5> values_;
};

/// Ornstein-Uhlenbeck velocities along x, y, z about a shear flow, positions their sums, stresslets that fluctuate cell by cell, ellipsoids at rest.
struct SyntheticRun {
  Eigen::Index times = 2000, cells = 30;
  double interval = 0.1;                           ///< strain
  double decay = std::exp(-0.2);                   ///< of velocity correlations from one sample to the next
  double deviation[3] = {0.2, 0.1, 0.15};          ///< of velocities, in shear_rate r
  double rate = 0.9;                               ///< of the mean flow, in shear rates
  double stresslet_deviation = 0.3;                ///< over the mean
  double viscosity = 1.8;                          ///< relative, of the whole box if cells were spread evenly
  double radius = 5, shear_rate = 1e-3;
  std::array<double, 3> box{40, 40, 60};
  std::uint64_t seed = 1;

  /// Exact, for positions that are sums and correlations that are integrated by trapezoids.
  double diffusivity(int axis) const { return deviation[axis] * deviation[axis] * interval * (1 + decay) / (1 - decay) / 2; }
  double relaxation_time() const { return interval * (1 + decay) / (1 - decay) / 2; }

  std::shared_ptr<MemoryCells> memory{};  ///< of the last record, to change it

  analysis::RunRecord record() {
    using enum analysis::CellQuantity;
    Normal normal(seed);
    analysis::RunRecord run;
    run.directory = "synthetic";
    run.capillary_number = 0.1;
    run.radius = radius;
    run.viscosity = 1.0 / 6;
    run.shear_rate = shear_rate;
    run.box = box;
    run.interval = interval;
    run.strain = interval * static_cast<double>(times - 1);
    run.samples = times;
    run.types = {{.name = "red_cell", .count = cells, .effective_radius = 1.05 * radius, .volume = 200, .effective_volume = 250}};
    run.type_of_cell.assign(static_cast<std::size_t>(cells), 0);
    run.phi_geometric = 200 * static_cast<double>(cells) / (box[0] * box[1] * box[2]);
    run.phi_nominal = run.phi_geometric;
    run.phi_effective = 1.25 * run.phi_geometric;
    memory = std::make_shared<MemoryCells>(times, cells);
    const double unit = shear_rate * radius, steps = interval / shear_rate;
    const double mean_stresslet = (viscosity - 1) * run.viscosity * shear_rate * box[0] * box[1] * box[2] / static_cast<double>(cells);
    for (Eigen::Index cell = 0; cell < cells; ++cell) {
      std::array<double, 3> x{}, v{};
      std::array<std::vector<double>, 3> u;
      for (std::size_t k = 0; k < 3; ++k) {
        x[k] = box[k] * normal.uniform();
        u[k] = ar1(decay, 0, static_cast<std::size_t>(times), normal);
      }
      const auto stress = ar1(decay, 0, static_cast<std::size_t>(times), normal);
      for (Eigen::Index t = 0; t < times; ++t) {
        const auto i = static_cast<std::size_t>(t);
        for (std::size_t k = 0; k < 3; ++k) v[k] = deviation[k] * unit * u[k][i];
        x[1] += v[1] * steps;
        x[2] += v[2] * steps;
        v[0] += rate * shear_rate * (x[2] - box[2] / 2);
        x[0] += v[0] * steps;
        for (int k = 0; k < 3; ++k) {
          memory->at(centre, t, cell, k) = x[static_cast<std::size_t>(k)];
          memory->at(velocity, t, cell, k) = v[static_cast<std::size_t>(k)];
        }
        const double s = mean_stresslet * (1 + stresslet_deviation * stress[i]);
        for (const auto& [part, factor] : {std::pair{2, 1.0}, {6, 1.0}, {0, 0.4}, {4, -0.1}, {8, -0.2}}) memory->at(stresslet, t, cell, part) = factor * s;
        set_ellipsoid(t, cell, 0.3);
        memory->at(volume, t, cell, 0) = 200;
      }
    }
    run.cells = memory;
    const auto n = static_cast<std::size_t>(times);
    run.relative_viscosity.assign(n, viscosity);
    run.wall_relative_viscosity.assign(n, viscosity);
    run.mean_deformation.assign(n, 0.5);
    run.volume_drift_max.assign(n, 0.002);
    run.area_drift_max.assign(n, 0.003);
    run.volume_drift_max[n / 2] = 0.01;
    run.bulk_stress.fill(std::vector<double>(n, 0.8 * run.viscosity * shear_rate));
    return run;
  }

  /// Semi-axes 3 (in the shear plane, at `angle` to +x), 2 (along y) and 1: D = 0.5, the shortest axis at `angle` + 90 degrees.
  void set_ellipsoid(Eigen::Index time, Eigen::Index cell, double angle) {
    const double a = 9.0 / 5, b = 4.0 / 5, c = 1.0 / 5, cs = std::cos(angle), sn = std::sin(angle);
    const double six[6] = {a * cs * cs + c * sn * sn, b, a * sn * sn + c * cs * cs, 0, (a - c) * cs * sn, 0};
    for (int k = 0; k < 6; ++k) memory->at(analysis::CellQuantity::gyration, time, cell, k) = six[k];
  }
};

/// Within `sigmas` of its errors, which must be positive; says what when not.
inline void agrees(const statistics::Estimate& estimate, double truth, double sigmas = 4) {
  CAPTURE(estimate.value, estimate.error, truth, estimate.reason);
  CHECK(estimate.error > 0);
  CHECK(std::abs(estimate.value - truth) < sigmas * estimate.error);
}

}  // namespace corpuscle::test
