// Stress of single cells: how it is distributed over the channel, how it fluctuates and for how long.
#include "physics/analysis/groups.hpp"
#include "physics/statistics/diffusion.hpp"
#include "physics/statistics/histogram.hpp"

namespace corpuscle::analysis {

void add_stresslets(const SteadyState& state, Analysis& analysis) {
  std::string missing = state.at_rest();
  if (missing.empty()) missing = state.without_bulk();
  if (!missing.empty()) return analysis.refuse(Group::stress, missing);
  constexpr int xz = 2;
  Eigen::MatrixXd stresslets = state.component(CellQuantity::stresslet, xz);
  const auto all = SteadyState::mean_of_cells(stresslets);
  analysis.curve("profile_stress_xz") =
      profile_curve(state, statistics::density_profile(state.heights, stresslets, state.record.box[0] * state.record.box[1], layers_of(state, all)), state.stress_unit(), all);

  const Eigen::MatrixXd in_bulk = stresslets.cwiseProduct(state.inside);
  auto& fluctuation = analysis.estimate("stress_fluctuation");
  fluctuation = statistics::relative_fluctuation(in_bulk);
  const double mean = statistics::moments(in_bulk, 1).mean.value;
  const auto squares = SteadyState::mean_of_cells((in_bulk.array() - mean).square().matrix());
  state.judge(fluctuation, squares);
  if (mean != 0) analysis.curve("pdf_stresslet") = statistics::probability_density(statistics::histogram_around_mean(in_bulk / mean));
  else analysis.curve("pdf_stresslet").reason = "the mean stresslet is zero";
  state.judge(analysis.curve("pdf_stresslet"), squares);

  stresslets.array() -= mean;
  const auto correlation = statistics::cross_correlation((in_bulk.array() - mean).matrix(), stresslets, state.interval, state.lags());
  analysis.curve("stresslet_autocorrelation") = statistics::normalised(statistics::thinned(correlation));
  analysis.estimate("stresslet_relaxation_time") = statistics::relaxation_time(correlation);
}

}  // namespace corpuscle::analysis
