// Fluctuations and diffusion of the cells while a run goes on, in memory that doesn't grow with its length: for runs too long to keep every trajectory.
// Host only. `corpuscle analyse` computes more, from trajectories in files.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "physics/sample.hpp"
#include "physics/statistics/histogram.hpp"
#include "physics/statistics/multiple_tau_correlator.hpp"
#include "physics/units.hpp"

namespace corpuscle {

/// Names of analyse's files with their values; x, y, z are flow, vorticity and gradient direction. Times in strain units, velocities in shear rate x r, lengths in r.
struct LiveResults {
  std::vector<std::pair<std::string, statistics::Estimate>> estimates;
  std::vector<std::pair<std::string, statistics::Curve>> curves;
  std::vector<std::pair<std::string, statistics::Fit>> fits;
  std::int64_t samples = 0;
  double from_strain = 0, to_strain = 0;
};

/// delta u = u - shear rate (z - L_z/2) e_x of the cells' centres, over the cells of the bulk (4 r away from each wall; all cells where no bulk is left, or without walls).
class LiveStatistics {
 public:
  /// @param discard share of the steps of the run that is left out at its start (RunSpec::discard); a run that is made longer later keeps its start
  LiveStatistics(const LatticeParameters& lattice, bool walls, double discard);

  /// Takes the next sample of the cadence `series_every`; others, and those of the start, are left out.
  void add(const Sample& sample);
  LiveResults result() const;

  /// What has been added, as plain numbers for a checkpoint: what goes on from them has the same results, bit for bit.
  std::vector<double> save() const;
  /// @throws OutputError when the numbers can't come from `save` of the same scene
  void restore(std::span<const double> saved);

  std::size_t bytes() const;
  /// What `bytes` will be, from the first sample on.
  static std::size_t predicted_bytes(std::size_t cells);
  std::int64_t samples() const { return samples_; }
  double wall_layer() const { return layer_ / radius_; }  ///< radii; 0: no bulk is left, or there are no walls

 private:
  static constexpr int bins = 120, stretches = 32;
  static constexpr double reach = 3;  ///< of the histograms, in shear rate x r
  void count(int component, std::span<const double> fluctuation);
  statistics::Histogram histogram(int component) const;

  std::size_t cells_;
  std::int64_t every_, first_step_;
  double shear_rate_, radius_, height_, layer_;
  std::vector<statistics::MultipleTauCorrelator> velocities_, positions_;  ///< of x, y, z; of y, z
  std::array<Eigen::MatrixXd, 3> counts_;  ///< [bins][stretches] of delta u
  Eigen::MatrixXd valid_;                  ///< [components][stretches], also those outside of the bins
  std::int64_t samples_ = 0, per_stretch_ = 1;
  double from_strain_ = 0, to_strain_ = 0;
};

}  // namespace corpuscle
