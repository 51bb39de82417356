// What all groups of observables share: where the steady part begins, where the bulk is, and which cell is in it when.
#pragma once
#include <optional>
#include <vector>

#include "physics/analysis/record.hpp"
#include "physics/analysis/results.hpp"
#include "physics/statistics/correlation.hpp"

namespace corpuscle::analysis {

inline constexpr Eigen::Index correlation_blocks = 8;  ///< the fewest that errors can be trusted with, so that they reach to the longest lags

/// The part of the channel that is averaged over.
struct Bulk {
  double low = 0, high = 0;  ///< lattice units
  double volume = 0;
  std::string missing;       ///< why there is none
};
Bulk bulk_of(const RunRecord& record, double wall_layer);

class SteadyState {
 public:
  /// Finds bulk and start-up. @throws InputError when an option doesn't fit the run.
  SteadyState(const RunRecord& record, const AnalysisOptions& options, Analysis& analysis);

  const RunRecord& record;
  const AnalysisOptions& options;
  Bulk bulk;
  Eigen::Index first = 0, times = 0;  ///< of the steady part on the record's grid
  double interval = 0;                ///< strain between times
  Eigen::MatrixXd heights;            ///< [times][cells] of the centres; empty without trajectories
  Eigen::MatrixXd inside;             ///< 1 in the bulk, NaN elsewhere; empty without trajectories or bulk
  /// Particle stress of the bulk over eta_0 shear_rate: xx, yy, zz, xz; empty where it isn't known.
  std::array<std::vector<double>, 4> stress;
  std::string stress_missing;         ///< why it isn't known

  double velocity_unit() const { return record.shear_rate * record.radius; }
  double stress_unit() const { return record.viscosity * record.shear_rate; }
  double height() const { return record.box[2]; }

  /// A quantity of the cells over the steady part.
  Eigen::MatrixXd component(CellQuantity quantity, int component) const { return record.cells->component(quantity, component, first, times); }
  /// A series of the record over the steady part.
  std::vector<double> steady(const std::vector<double>& series) const { return {series.begin() + first, series.end()}; }

  /// Why nothing that needs trajectories, or the bulk, or several cells in it, or a shear rate can be computed; empty where it can.
  std::string without_cells() const;
  std::string without_bulk() const;
  std::string without_company() const;
  std::string at_rest() const;

  statistics::CorrelationOptions lags(statistics::MeanRemoval removal = statistics::MeanRemoval::none) const;
  /// Stretches of time for averages of a quantity whose mean over the cells is this series.
  Eigen::Index blocks(const std::vector<double>& series) const;
  /// Mean over the cells at each time.
  static std::vector<double> mean_of_cells(const Eigen::MatrixXd& values);
  /// Gives an average the correlation time of `series`, its mean over the cells, and doubts it where the steady part is too short for that.
  void judge(statistics::Estimate& estimate, const std::vector<double>& series) const;
  /// Doubts a curve or a fit likewise.
  template <class Result>
  void judge(Result& result, const std::vector<double>& series) const {
    if (const std::string reason = too_short_for(series); !reason.empty()) statistics::doubt(result, reason);
  }

 private:
  std::string too_short_for(const std::vector<double>& series) const;
  void find_start_up(Analysis& analysis);
  std::vector<double> velocity_variances() const;

  Eigen::MatrixXd all_heights_;  // of the whole run, until the start-up is known
  std::array<std::vector<double>, 4> all_stress_;
  void compute_stress();
};

}  // namespace corpuscle::analysis
