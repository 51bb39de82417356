#include "physics/analysis/steady_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "physics/statistics/autocorrelation_time.hpp"
#include "physics/statistics/profile.hpp"

namespace corpuscle::analysis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double layer_of_series = 4;  // radii that /series/bulk_particle_stress leaves out

}  // namespace

Bulk bulk_of(const RunRecord& record, double wall_layer) {
  const double height = record.box[2], layer = record.walls ? wall_layer * record.radius : 0;
  Bulk bulk{.low = layer, .high = height - layer, .volume = record.box[0] * record.box[1] * (height - 2 * layer), .missing = {}};
  if (!record.walls) bulk.low = -std::numeric_limits<double>::infinity(), bulk.high = -bulk.low;  // centres are unwrapped
  if (!(height > 2 * layer)) {
    bulk.missing = fmt::format("no bulk is left: layers of {:g} radii at both walls fill the channel, {:.3g} radii high (--wall-layer takes thinner ones)", wall_layer,
                               height / record.radius);
  }
  return bulk;
}

SteadyState::SteadyState(const RunRecord& run, const AnalysisOptions& choices, Analysis& analysis)
    : record(run), options(choices), bulk(bulk_of(run, choices.wall_layer)), interval(run.interval) {
  if (!(options.wall_layer >= 0)) throw InputError(fmt::format("--wall-layer {:g} must be 0 or more radii", options.wall_layer));
  if (record.times() < 1) throw InputError(fmt::format("{}: run.h5 holds no sample yet; wait for the run, or run it again", record.directory));
  if (without_cells().empty()) all_heights_ = record.cells->component(CellQuantity::centre, 2, 0, record.times());
  compute_stress();
  find_start_up(analysis);

  times = record.times() - first;
  for (std::size_t k = 0; k < 4; ++k)
    if (!all_stress_[k].empty()) stress[k] = steady(all_stress_[k]);
  if (all_heights_.size() > 0) {
    heights = all_heights_.bottomRows(times);
    all_heights_.resize(0, 0);
    if (!record.walls) heights.array() -= height() * (heights.array() / height()).floor();
    if (bulk.missing.empty()) inside = statistics::within(heights, bulk.low, bulk.high);
  }
  if (!std::isnan(options.longest_lag) && !(options.longest_lag > 0 && std::isfinite(options.longest_lag))) {
    throw InputError(fmt::format("--longest-lag {:g} must be a strain above 0", options.longest_lag));
  }
  const double steady_strain = interval * static_cast<double>(times - 1);
  if (options.longest_lag > steady_strain) {
    throw InputError(fmt::format("--longest-lag {:g} is beyond the steady part of the run, {:.4g} strains: give less, or run longer", options.longest_lag, steady_strain));
  }
  analysis.settings.asked = options;
  analysis.settings.wall_layer = record.walls ? options.wall_layer : 0;
  analysis.settings.mean_flow = options.mean_flow;
  analysis.settings.discarded_strain = analysis.start_up_strain = std::isnan(interval) ? 0 : interval * static_cast<double>(first);
  analysis.settings.longest_lag = interval * static_cast<double>(std::min(lags().longest_lag, times - 1));
}

void SteadyState::compute_stress() {
  const Index all = record.times();
  if (record.flow == FlowOf::rest) stress_missing = at_rest();
  if (record.flow == FlowOf::poiseuille) stress_missing = "in channel flow stress and shear rate change across the bulk: see profile_stress_xz";
  if (stress_missing.empty() && !bulk.missing.empty()) stress_missing = bulk.missing;
  if (!stress_missing.empty()) return;
  const double unit = stress_unit();
  if (all_heights_.size() > 0) {
    for (auto& series : all_stress_) series.assign(static_cast<std::size_t>(all), statistics::not_a_number);
    record.cells->visit(CellQuantity::stresslet, 0, [&](Index time, std::span<const double> values) {
      constexpr std::array<std::size_t, 4> parts{0, 4, 8, 2};  // xx, yy, zz, xz
      std::array<double, 4> sums{};
      for (Index cell = 0; cell < all_heights_.cols(); ++cell) {
        const double z = all_heights_(time, cell);
        if (!(z >= bulk.low && z <= bulk.high)) continue;
        for (std::size_t k = 0; k < 4; ++k) sums[k] += values[9 * static_cast<std::size_t>(cell) + parts[k]];
      }
      for (std::size_t k = 0; k < 4; ++k) all_stress_[k][static_cast<std::size_t>(time)] = sums[k] / (bulk.volume * unit);
    });
  } else if (options.wall_layer == layer_of_series) {
    for (std::size_t k = 0; k < 4; ++k) {
      for (const double value : record.bulk_stress[k]) all_stress_[k].push_back(value / unit);
    }
  } else {
    stress_missing = fmt::format("run.h5 holds the stress {:g} radii away from the walls only; for another layer trajectories are needed (output.trajectories)",
                                 layer_of_series);
  }
}

// (<v_y^2> + <v_z^2>)/2 over the cells in the bulk at each time: directions without mean flow.
std::vector<double> SteadyState::velocity_variances() const {
  std::vector<double> series(static_cast<std::size_t>(record.times()), statistics::not_a_number);
  record.cells->visit(CellQuantity::velocity, 0, [&](Index time, std::span<const double> values) {
    double sum = 0, count = 0;
    for (Index cell = 0; cell < all_heights_.cols(); ++cell) {
      const double z = all_heights_(time, cell);
      if (!(z >= bulk.low && z <= bulk.high)) continue;
      const double* v = &values[3 * static_cast<std::size_t>(cell)];
      sum += 0.5 * (v[1] * v[1] + v[2] * v[2]);
      count += 1;
    }
    if (count > 0) series[static_cast<std::size_t>(time)] = sum / count;
  });
  return series;
}

void SteadyState::find_start_up(Analysis& analysis) {
  if (!std::isnan(options.discard)) {
    if (record.flow == FlowOf::rest) throw InputError("--discard is a strain, which a fluid at rest has none of: leave it out");
    if (!(options.discard >= 0)) throw InputError(fmt::format("--discard {:g} must be a strain of 0 or more", options.discard));
    const double wanted = std::ceil(options.discard / interval - 1e-9);
    if (!(wanted < static_cast<double>(record.times()))) {
      throw InputError(fmt::format("--discard {:g} leaves no sample of a run that has come to {:.4g} strains: discard less, or run longer", options.discard, record.strain));
    }
    first = static_cast<Index>(wanted);
    analysis.start_up = {.first = static_cast<std::size_t>(first), .converged = true, .reason = {}};
    return;
  }
  std::vector<std::pair<const char*, std::vector<double>>> candidates;
  if (!all_stress_[3].empty()) candidates.emplace_back("the stress of the bulk", all_stress_[3]);
  if (all_heights_.cols() > 1 && bulk.missing.empty()) candidates.emplace_back("the velocity variance of the bulk", velocity_variances());
  candidates.emplace_back("the deformation", record.mean_deformation);
  if (record.cell_count() == 0) candidates = {{"the wall stress", record.wall_relative_viscosity}};
  analysis.start_up.converged = true;
  for (const auto& [name, series] : candidates) {
    if (std::none_of(series.begin(), series.end(), [](double x) { return std::isfinite(x); })) continue;
    const auto end = statistics::equilibration(series);
    analysis.start_up.first = std::max(analysis.start_up.first, end.first);
    if (!end.converged) statistics::doubt(analysis.start_up, fmt::format("{}: {}", name, end.reason));
  }
  first = std::min(static_cast<Index>(analysis.start_up.first), record.times() - 1);
}

std::string SteadyState::without_cells() const {
  if (record.cell_count() == 0) return "there are no cells";
  if (!record.cells) return "the run wrote no trajectories (output.trajectories = true)";
  return {};
}

std::string SteadyState::without_bulk() const {
  const std::string reason = without_cells();
  return reason.empty() ? bulk.missing : reason;
}

std::string SteadyState::without_company() const {
  std::string reason = without_bulk();
  if (reason.empty() && record.cell_count() < 2) reason = "one cell has no fluctuations about a mean flow and no neighbours";
  return reason;
}

std::string SteadyState::at_rest() const {
  return record.shear_rate > 0 ? std::string() : "the fluid is at rest: there is no shear rate to measure with";
}

statistics::CorrelationOptions SteadyState::lags(statistics::MeanRemoval removal) const {
  Index longest = std::max<Index>(times / 4, 1);
  if (!std::isnan(options.longest_lag)) longest = std::max<Index>(std::lround(options.longest_lag / interval), 1);
  return {.longest_lag = longest, .removal = removal, .blocks_of = statistics::Blocks::times, .blocks = correlation_blocks};
}

Index SteadyState::blocks(const std::vector<double>& series) const {
  return statistics::block_count(times, statistics::autocorrelation_time(series).time, statistics::blocks_to_trust);
}

std::vector<double> SteadyState::mean_of_cells(const MatrixXd& values) {
  std::vector<double> means(static_cast<std::size_t>(values.rows()), statistics::not_a_number);
  for (Index t = 0; t < values.rows(); ++t) {
    double sum = 0, count = 0;
    for (Index cell = 0; cell < values.cols(); ++cell) {
      if (std::isnan(values(t, cell))) continue;
      sum += values(t, cell);
      count += 1;
    }
    if (count > 0) means[static_cast<std::size_t>(t)] = sum / count;
  }
  return means;
}

std::string SteadyState::too_short_for(const std::vector<double>& series) const {
  constexpr double times_to_trust = 20;  // as for the mean of a series
  const auto tau = statistics::autocorrelation_time(series);
  if (tau.constant || (tau.window_closed && tau.valid_samples >= times_to_trust * tau.time)) return {};
  return fmt::format("the steady part, {} samples, is shorter than {:g} correlation times of {:.3g} samples", times, times_to_trust, tau.time);
}

void SteadyState::judge(statistics::Estimate& estimate, const std::vector<double>& series) const {
  if (std::isnan(estimate.value)) return;
  estimate.correlation_time = statistics::autocorrelation_time(series).time * interval;
  if (const std::string reason = too_short_for(series); !reason.empty()) statistics::doubt(estimate, reason);
}

}  // namespace corpuscle::analysis
