// Viscosities, normal stresses and the fluctuations of the whole bulk's stress.
#include <cmath>

#include "physics/analysis/groups.hpp"
#include "physics/statistics/autocorrelation_time.hpp"
#include "physics/statistics/histogram.hpp"
#include "physics/statistics/mean_error.hpp"

namespace corpuscle::analysis {
namespace {

using statistics::Estimate;

constexpr double resolved = 0.6;  // of its first value that a correlation must keep to the next sample for its integral to mean something

std::vector<double> combined(const std::array<std::vector<double>, 4>& stress, const std::array<double, 4>& factors) {
  std::vector<double> series(stress[0].size());
  for (std::size_t i = 0; i < series.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k)
      if (factors[k] != 0) series[i] += factors[k] * stress[k][i];
  }
  return series;
}

// Integral of the normalised correlation of one series: the subtracted mean lowers it, which the integrated time puts right.
Estimate relaxation_of(const std::vector<double>& series, double interval, double next) {
  const auto tau = statistics::autocorrelation_time(series);
  Estimate result;
  result.value = result.correlation_time = tau.time * interval;
  result.error = tau.error * interval;
  result.effective_samples = tau.constant ? 0 : tau.variance / tau.mean_variance;
  result.converged = true;
  if (!(tau.valid_samples >= 2) || tau.constant) {
    result = {.reason = "nothing fluctuates, or there are too few samples"};
  } else if (!tau.window_closed || tau.valid_samples < 20 * tau.time) {
    doubt(result, "the series is shorter than 20 of its correlation times");
  } else if (next < resolved) {
    doubt(result, "the samples lie too far apart: the correlation falls below 60 % within one interval (output.series_every)");
  }
  return result;
}

}  // namespace

void add_rheology(const SteadyState& state, Analysis& analysis) {
  const RunRecord& record = state.record;
  const bool rest = record.flow == FlowOf::rest;
  const auto mean = [&](const std::vector<double>& series) { return statistics::mean_estimate(series, state.interval); };
  if (rest) {
    analysis.refuse(Group::walls, state.at_rest());
  } else {
    analysis.estimate("whole_relative_viscosity") = mean(state.steady(record.relative_viscosity));
    Estimate& intrinsic = analysis.estimate("intrinsic_viscosity");
    intrinsic.reason = "there are no cells";
    if (record.phi_nominal > 0) {
      intrinsic = analysis.estimate("whole_relative_viscosity");
      intrinsic.value = (intrinsic.value - 1) / record.phi_nominal;
      intrinsic.error /= record.phi_nominal;
    }
    Estimate& wall = analysis.estimate("wall_relative_viscosity");
    if (record.flow == FlowOf::shear) wall = mean(state.steady(record.wall_relative_viscosity));
    else wall.reason = "in channel flow the wall stress is given by the body force";
  }
  std::string missing = record.cell_count() == 0 ? "there are no cells" : state.stress_missing;
  if (!missing.empty()) return analysis.refuse(Group::rheology, missing);

  const auto& xz = state.stress[3];
  Estimate viscosity = mean(xz);
  viscosity.value += 1;
  analysis.estimate("relative_viscosity") = viscosity;
  analysis.estimate("normal_stress_difference_1") = mean(combined(state.stress, {1, 0, -1, 0}));
  analysis.estimate("normal_stress_difference_2") = mean(combined(state.stress, {0, -1, 1, 0}));
  analysis.estimate("particle_pressure") = mean(combined(state.stress, {-1.0 / 3, -1.0 / 3, -1.0 / 3, 0}));
  analysis.estimate("relative_viscosity_local_rate").reason = "the shear rate of the bulk isn't known";  // until the velocities are there

  const Eigen::Map<const Eigen::MatrixXd> column(xz.data(), state.times, 1);
  Estimate& fluctuation = analysis.estimate("bulk_stress_fluctuation");
  fluctuation = statistics::relative_fluctuation(column);
  state.judge(fluctuation, xz);
  const auto correlation = statistics::autocorrelation(column, state.interval, state.lags(statistics::MeanRemoval::overall));
  analysis.curve("stress_autocorrelation") = statistics::normalised(statistics::thinned(correlation));
  double next = 0;
  if (correlation.points() > 1) next = correlation.value()[1] / correlation.value()[0];
  analysis.estimate("stress_relaxation_time") = relaxation_of(xz, state.interval, next);
}

}  // namespace corpuscle::analysis
