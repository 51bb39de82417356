// Where the cells are: volume fractions, pair distribution, contacts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "physics/analysis/groups.hpp"
#include "physics/statistics/mean_error.hpp"
#include "physics/statistics/pair_distribution.hpp"

namespace corpuscle::analysis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using statistics::PairDistribution;

constexpr Index most_snapshots = 200;    // neighbouring ones tell nearly the same, and pairs cost time
constexpr double longest_distance = 8;   // radii
constexpr double bin_width = 0.1;        // radii

void add_volume_fractions(const SteadyState& state, Analysis& analysis) {
  const RunRecord& record = state.record;
  const Eigen::MatrixXd volumes = state.component(CellQuantity::volume, 0);
  Eigen::MatrixXd effective = volumes;
  for (Index cell = 0; cell < effective.cols(); ++cell) {
    const auto& type = record.types[static_cast<std::size_t>(record.type_of_cell[static_cast<std::size_t>(cell)])];
    effective.col(cell) *= type.effective_volume / type.volume;
  }
  const auto fraction_of = [&](const Eigen::MatrixXd& each) {
    std::vector<double> fraction(static_cast<std::size_t>(state.times), statistics::not_a_number);
    for (Index t = 0; t < state.times; ++t) {
      double sum = 0;
      bool sampled = false;
      for (Index cell = 0; cell < each.cols(); ++cell) {
        sampled = sampled || !std::isnan(each(t, cell));
        if (!std::isnan(state.inside(t, cell)) && !std::isnan(each(t, cell))) sum += each(t, cell);
      }
      if (sampled) fraction[static_cast<std::size_t>(t)] = sum / state.bulk.volume;
    }
    return fraction;
  };
  const auto fraction = fraction_of(effective);
  analysis.estimate("phi_bulk") = statistics::mean_estimate(fraction, state.interval);
  analysis.estimate("phi_bulk_geometric") = statistics::mean_estimate(fraction_of(volumes), state.interval);
  analysis.curve("profile_phi") = profile_curve(
      state, statistics::density_profile(state.heights, effective, record.box[0] * record.box[1], layers_of(state, fraction)), 1, fraction);
}

Index snapshot_interval(const SteadyState& state) { return std::max<Index>((state.times + most_snapshots - 1) / most_snapshots, 1); }

template <class Take>
void visit_snapshots(const SteadyState& state, const Take& take) {
  const Index every = snapshot_interval(state);
  state.record.cells->visit(CellQuantity::centre, state.first, [&](Index time, std::span<const double> centres) {
    if ((time - state.first) % every == 0) take(time - state.first, centres);
  });
}

// The first minimum of g beyond its first peak, both of three bins' means and farther apart than 3 errors; NaN where noise hides them.
double first_minimum(const statistics::Curve& g) {
  const Index n = g.value.size();
  const auto smooth = [&](const VectorXd& y, Index i) { return (y[i - 1] + y[i] + y[i + 1]) / 3; };
  constexpr Index reach = 3;  // bins on both sides that must not be beyond
  Index peak = -1;
  for (Index i = 1; i + 1 < n; ++i) {
    const double here = smooth(g.value, i);
    if (!std::isfinite(here)) continue;
    bool highest = here > 1, lowest = peak > 0;
    for (Index k = std::max<Index>(i - reach, 1); k <= std::min(i + reach, n - 2); ++k) {
      const double there = smooth(g.value, k);
      highest = highest && !(there > here);
      lowest = lowest && !(there < here);
    }
    if (peak < 0 && highest) peak = i;
    if (lowest && i > peak) return smooth(g.value, peak) - here > 3 * std::hypot(smooth(g.error, peak), smooth(g.error, i)) ? g.x[i] : statistics::not_a_number;
  }
  return statistics::not_a_number;
}

void add_pairs(const SteadyState& state, Analysis& analysis) {
  const RunRecord& record = state.record;
  statistics::PairOptions options;
  options.size = record.box;
  options.periodic = {true, true, !record.walls};
  options.wall_layer = record.walls ? state.bulk.low : 0;
  double half = longest_distance * record.radius;
  for (std::size_t k = 0; k < 3; ++k)
    if (options.periodic[k]) half = std::min(half, record.box[k] / 2);
  options.reach = half;
  options.bins = std::max<Index>(std::lround(half / (bin_width * record.radius)), 1);
  PairDistribution pairs(options);
  visit_snapshots(state, [&](Index, std::span<const double> centres) { pairs.add(centres); });
  const auto distribution = statistics::with_errors(pairs.result());
  auto& curve = analysis.curve("pair_distribution");
  curve = distribution;
  curve.x /= record.radius;

  auto& settings = analysis.settings;
  const double minimum = first_minimum(curve), diameters = 1.5 * 2 * record.mean_effective_radius() / record.radius;
  settings.contact_distance = std::isnan(minimum) ? diameters : minimum;
  settings.contact_distance_from = std::isnan(minimum) ? "1.5 effective diameters: g(r) shows no first minimum" : "first minimum of g(r)";
  auto& contacts = analysis.estimate("contact_number");
  options.contact_distance = settings.contact_distance * record.radius;
  if (options.contact_distance > half) {
    contacts.reason = fmt::format("the contact distance, {:.3g} radii, is more than half of the periodic box", settings.contact_distance);
    return;
  }
  options.reach = options.contact_distance;
  options.bins = 1;
  const Index every = snapshot_interval(state);
  std::vector<double> series(static_cast<std::size_t>((state.times - 1) / every + 1), statistics::not_a_number);
  visit_snapshots(state, [&](Index time, std::span<const double> centres) {
    PairDistribution neighbours(options);
    neighbours.add(centres);
    series[static_cast<std::size_t>(time / every)] = neighbours.contact_number({.resamples = 0}).value;
  });
  contacts = statistics::mean_estimate(series, static_cast<double>(every) * state.interval);
  state.judge(curve, series);  // neighbourhoods last
}

}  // namespace

void add_structure(const SteadyState& state, Analysis& analysis) {
  const std::string missing = state.without_bulk();
  if (!missing.empty()) return analysis.refuse(Group::structure, missing);
  add_volume_fractions(state, analysis);
  if (const std::string alone = state.without_company(); alone.empty()) {
    add_pairs(state, analysis);
  } else {
    analysis.curve("pair_distribution").reason = analysis.estimate("contact_number").reason = alone;
  }
}

}  // namespace corpuscle::analysis
