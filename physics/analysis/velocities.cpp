// Velocity fluctuations of the cells about the mean flow: profiles, variances, densities, correlations, and what is integrated from these.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "physics/analysis/groups.hpp"
#include "physics/statistics/diffusion.hpp"
#include "physics/statistics/histogram.hpp"

namespace corpuscle::analysis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using statistics::BlockedCurve;
using statistics::Curve;
using statistics::Estimate;

constexpr double fit_until = 1;  // strain: a stretched exponential describes the first decay only

/// Velocities along x minus the uniform shear flow, and their mean in layers of z: the rest of the mean flow, which changes slowly, so that layers of
/// finite thickness take nothing of the shear for a fluctuation.
struct FlowProfile {
  MatrixXd about_uniform;  // [times][cells]
  BlockedCurve rest;
  double uniform_rate = 0;
  std::vector<double> squares;  // of `about_uniform`, mean over the cells
};

FlowProfile flow_of(const SteadyState& state) {
  FlowProfile flow;
  flow.uniform_rate = state.record.flow == FlowOf::shear ? state.record.shear_rate : 0;
  flow.about_uniform = statistics::fluctuations(state.heights, state.component(CellQuantity::velocity, 0), flow.uniform_rate, state.height() / 2);
  flow.squares = SteadyState::mean_of_cells(flow.about_uniform.cwiseAbs2());
  flow.rest = statistics::profile(state.heights, flow.about_uniform, layers_of(state, flow.squares));
  return flow;
}

// Slope of the straight line through the velocities of all cells in the bulk against their heights. Not through the means in layers: these would have to stand for
// the heights of the few cells in a layer.
Estimate slope_of(const SteadyState& state, const MatrixXd& velocities, Index blocks) {
  BlockedCurve means;  // of z, u, z^2, z u
  means.x = VectorXd::LinSpaced(4, 0, 3);
  means.sums = means.counts = MatrixXd::Zero(4, blocks);
  VectorXd terms(4);
  for (Index cell = 0; cell < velocities.cols(); ++cell) {
    for (Index b = 0; b < blocks; ++b) {
      for (Index t = b * state.times / blocks; t < (b + 1) * state.times / blocks; ++t) {
        const double z = (state.heights(t, cell) - state.height() / 2) * state.inside(t, cell), u = velocities(t, cell);
        if (std::isnan(z + u)) continue;
        terms << z, u, z * z, z * u;
        means.sums.col(b) += terms;
        means.counts.col(b).array() += 1;
      }
    }
  }
  if (means.counts.sum() <= 0) means.reason = "no cell is in the bulk";
  return statistics::estimate_from(means, [](const VectorXd& m) { return (m[3] - m[0] * m[1]) / (m[2] - m[0] * m[0]); });
}

void add_mean_flow(const SteadyState& state, const FlowProfile& flow, Analysis& analysis) {
  Curve& profile = analysis.curve("profile_velocity");
  profile = profile_curve(state, flow.rest, state.velocity_unit(), flow.squares);
  profile.value.array() += flow.uniform_rate / state.record.shear_rate * (profile.x.array() - state.height() / (2 * state.record.radius));
  Estimate& slope = analysis.estimate("shear_rate_bulk");
  if (state.record.flow != FlowOf::shear) {
    slope.reason = "in channel flow the shear rate changes across the bulk: see profile_velocity";
    return;
  }
  slope = slope_of(state, flow.about_uniform / state.record.shear_rate, flow.rest.blocks());
  slope.value += 1;
  // It moves with the cells' mean velocity weighted by their height.
  const MatrixXd tilt = flow.about_uniform.cwiseProduct(((state.heights.array() - state.height() / 2) * state.inside.array()).matrix());
  state.judge(slope, SteadyState::mean_of_cells(tilt));

  const Estimate& viscosity = analysis.estimate("relative_viscosity");
  if (std::isnan(viscosity.value)) {
    analysis.estimate("relative_viscosity_local_rate").reason = viscosity.reason;
    return;
  }
  Estimate& local = analysis.estimate("relative_viscosity_local_rate");
  local = {.value = 1 + (viscosity.value - 1) / slope.value, .correlation_time = viscosity.correlation_time, .effective_samples = viscosity.effective_samples, .converged = true};
  local.error = std::hypot(viscosity.error, (viscosity.value - 1) * slope.error / slope.value) / std::abs(slope.value);
  if (!viscosity.converged) doubt(local, viscosity.reason);
  if (!slope.converged) doubt(local, "shear rate of the bulk: " + slope.reason);
}

MatrixXd fluctuations_of(const SteadyState& state, const FlowProfile& flow, int axis) {
  MatrixXd velocities;
  if (axis > 0) velocities = state.component(CellQuantity::velocity, axis);
  else if (state.options.mean_flow == MeanFlow::uniform) velocities = flow.about_uniform;
  else velocities = statistics::fluctuations(state.heights, flow.about_uniform, statistics::with_errors(flow.rest, {}, {.resamples = 0}));
  return velocities / state.velocity_unit();
}

void add_density(const MatrixXd& in_bulk, const std::string& name, Analysis& analysis) {
  const auto histogram = statistics::histogram_around_mean(in_bulk);
  analysis.curve("pdf_velocity_" + name) = statistics::probability_density(histogram);
  const auto parts = statistics::fit_core_and_tails(histogram);
  statistics::Fit& fit = analysis.fit("pdf_velocity_" + name + "_core_and_tails").fit;
  std::vector<double> values, errors;
  const auto add = [&](const std::string& parameter, double value, double error) {
    fit.names.push_back(parameter);
    values.push_back(value);
    errors.push_back(error);
  };
  fit.converged = true;
  fit.chi2 = 0;
  for (const auto& [part, found] : {std::pair{"core", &parts.core}, {"lower", &parts.lower}, {"upper", &parts.upper}}) {
    for (std::size_t i = 0; i < found->names.size(); ++i) {
      const auto k = static_cast<Index>(i);
      add(fmt::format("{}_{}", part, found->names[i]), found->parameters[k], found->errors[k]);
    }
    fit.chi2 += found->chi2;
    fit.degrees_of_freedom += found->degrees_of_freedom;
    if (!found->converged) doubt(fit, fmt::format("{}: {}", part, found->reason));
  }
  add("lower_start", parts.lower_start, statistics::not_a_number);
  add("upper_start", parts.upper_start, statistics::not_a_number);
  add("gaussian_tail", parts.gaussian_tail, statistics::not_a_number);
  fit.parameters = Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()));
  fit.errors = Eigen::Map<const VectorXd>(errors.data(), static_cast<Index>(errors.size()));
}

void add_correlations(const SteadyState& state, const MatrixXd& all, const MatrixXd& in_bulk, const std::string& name, Analysis& analysis) {
  // Cells that are in the bulk at the beginning of the lag, wherever they are later, as for the displacements.
  const BlockedCurve vacf = statistics::cross_correlation(in_bulk, all, state.interval, state.lags());
  const BlockedCurve few = statistics::thinned(vacf);
  analysis.curve("vacf_" + name) = statistics::normalised(few);
  analysis.estimate("relaxation_time_" + name) = statistics::relaxation_time(vacf);
  if (name == "x") return;
  analysis.estimate("diffusivity_vacf_" + name) = statistics::diffusion_from_vacf(vacf);
  const double until = std::min(fit_until, vacf.trusted_until());
  auto stretched = statistics::diffusion_from_stretched_exponential(few, until);
  constexpr double times_a_block = 6;  // relaxation times: shorter stretches of time aren't independent
  if (vacf.block_length < times_a_block * stretched.diffusion.correlation_time) {
    const std::string reason = fmt::format("blocks of {:.3g} strains are shorter than {:g} relaxation times: errors are too small", vacf.block_length, times_a_block);
    doubt(stretched.diffusion, reason);
    doubt(stretched.fit, reason);
  }
  analysis.estimate("diffusivity_gamma_" + name) = stretched.diffusion;
  NamedFit& fit = analysis.fit("vacf_" + name + "_stretched_exponential");
  fit.fit = stretched.fit;
  fit.from = 0;
  fit.to = until;
  if (vacf.points() == 0 || fit.fit.parameters.size() < 3) return;
  // To lie on the normalised curve.
  const double start = vacf.value()[0];
  fit.fit.parameters[0] /= start;
  fit.fit.errors[0] /= start;
  fit.fit.covariance.row(0) /= start;
  fit.fit.covariance.col(0) /= start;
}

}  // namespace

void add_velocities(const SteadyState& state, Analysis& analysis) {
  std::string missing = state.at_rest();
  if (missing.empty()) missing = state.without_company();
  if (!missing.empty()) {
    if (analysis.estimate("relative_viscosity_local_rate").reason.starts_with("the shear rate of the bulk")) analysis.estimate("relative_viscosity_local_rate").reason = missing;
    return analysis.refuse(Group::velocity, missing);
  }
  const FlowProfile flow = flow_of(state);
  add_mean_flow(state, flow, analysis);
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name(1, "xyz"[axis]);
    const MatrixXd all = fluctuations_of(state, flow, axis), in_bulk = all.cwiseProduct(state.inside);
    const auto moments = statistics::moments(in_bulk);
    const auto squares = SteadyState::mean_of_cells(in_bulk.cwiseAbs2());
    Estimate &variance = analysis.estimate("velocity_variance_" + name), &kurtosis = analysis.estimate("velocity_kurtosis_" + name);
    variance = moments.variance;
    kurtosis = moments.excess_kurtosis;
    state.judge(variance, squares);
    state.judge(kurtosis, squares);
    if (axis > 0 && std::abs(moments.mean.value) > std::max(4 * moments.mean.error, 0.1 * std::sqrt(variance.value))) {
      analysis.warnings.push_back(fmt::format("the cells of the bulk drift along {} with {:.3g} +- {:.1g} gamma_dot r: variances are about that mean, correlations and "
                                              "displacements contain it", name, moments.mean.value, moments.mean.error));
    }
    analysis.curve("profile_variance_" + name) =
        profile_curve(state, statistics::profile(state.heights, all.cwiseAbs2(), layers_of(state, squares)), 1, squares);
    add_density(in_bulk, name, analysis);
    state.judge(analysis.curve("pdf_velocity_" + name), squares);
    state.judge(analysis.fit("pdf_velocity_" + name + "_core_and_tails").fit, squares);
    add_correlations(state, all, in_bulk, name, analysis);
  }
}

}  // namespace corpuscle::analysis
