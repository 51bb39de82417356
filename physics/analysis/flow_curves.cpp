#include "physics/analysis/flow_curves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "physics/statistics/dissipation.hpp"

namespace corpuscle::analysis {
namespace {

using Eigen::Index;
using statistics::Estimate;
using statistics::Fit;

constexpr double same_fraction = 0.02;

// Fits need one point more than they have parameters, or nothing tests them.
Fit fitted(const statistics::FitData& data, Index least, const std::vector<std::string>& unconverged, Fit (*fit)(const statistics::FitData&)) {
  const Index valid = (data.y.array().isFinite() && data.error.array() > 0).count();
  if (valid < least) return {.reason = fmt::format("{} viscosities with errors are too few for this fit (at least {})", valid, least)};
  Fit result = fit(data);
  if (!unconverged.empty()) doubt(result, fmt::format("viscosities aren't converged: {}", fmt::join(unconverged, ", ")));
  return result;
}

FlowCurve curve_of(std::vector<RunOutcome> runs) {
  std::stable_sort(runs.begin(), runs.end(), [](const RunOutcome& a, const RunOutcome& b) { return a.capillary_number < b.capillary_number; });
  const auto n = static_cast<Index>(runs.size());
  FlowCurve curve;
  statistics::FitData data{.x = Eigen::VectorXd(n), .y = Eigen::VectorXd(n), .error = Eigen::VectorXd(n)};
  std::vector<std::string> unconverged;
  for (Index i = 0; i < n; ++i) {
    const RunOutcome& run = runs[static_cast<std::size_t>(i)];
    curve.runs.push_back(run.directory);
    curve.phi_effective += run.phi_effective / static_cast<double>(n);
    curve.phi_geometric += run.phi_geometric / static_cast<double>(n);
    data.x[i] = run.capillary_number;
    data.y[i] = run.viscosity.value;
    data.error[i] = run.viscosity.error;
    if (std::isfinite(run.viscosity.value) && !run.viscosity.converged) unconverged.push_back(run.directory);
  }
  curve.shear_thinning = fitted(data, 3, unconverged, statistics::fit_shear_thinning);
  curve.yield_stress = fitted(data, 4, unconverged, statistics::fit_yield_stress);
  return curve;
}

}  // namespace

std::vector<FlowCurve> flow_curves(std::vector<RunOutcome> runs) {
  std::erase_if(runs, [](const RunOutcome& run) { return !(run.capillary_number > 0) || !(run.phi_effective > 0); });
  std::stable_sort(runs.begin(), runs.end(), [](const RunOutcome& a, const RunOutcome& b) { return a.phi_effective < b.phi_effective; });
  std::vector<FlowCurve> curves;
  for (std::size_t from = 0; from < runs.size();) {
    std::size_t to = from;
    while (to < runs.size() && runs[to].phi_effective <= runs[from].phi_effective * (1 + same_fraction)) ++to;
    curves.push_back(curve_of({runs.begin() + static_cast<std::ptrdiff_t>(from), runs.begin() + static_cast<std::ptrdiff_t>(to)}));
    from = to;
  }
  return curves;
}

Estimate critical_volume_fraction(const std::vector<FlowCurve>& curves) {
  std::vector<double> phi, stress, error;
  bool trusted = true;
  for (const FlowCurve& curve : curves) {
    const Estimate yield = curve.yield_stress.parameter("yield_stress");
    if (!(yield.error > 0) || !(yield.value > 2 * yield.error)) continue;
    phi.push_back(curve.phi_effective);
    stress.push_back(yield.value);
    error.push_back(yield.error);
    trusted = trusted && yield.converged;
  }
  if (phi.size() < 2) {
    return {.reason = fmt::format("{} of {} volume fractions have a yield stress above twice its error: two are needed for a line", phi.size(), curves.size())};
  }
  const auto vector = [](const std::vector<double>& v) { return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Index>(v.size()))); };
  const Fit line = statistics::fit_line({.x = vector(phi), .y = vector(stress), .error = vector(error)});
  if (!line.converged) return {.reason = line.reason};
  const double intercept = line.parameters[0], slope = line.parameters[1];
  if (!(slope > 0)) return {.reason = "the yield stress doesn't grow with the volume fraction"};
  Estimate critical{.value = -intercept / slope, .effective_samples = static_cast<double>(phi.size()), .converged = true};
  const Eigen::Vector2d gradient(-1 / slope, intercept / (slope * slope));
  critical.error = std::sqrt(gradient.dot(line.covariance * gradient));
  if (!trusted) {
    doubt(critical, "yield stresses of the line aren't converged");
  } else if (phi.size() == 2) {
    doubt(critical, "a line through two points: nothing tests that it is straight");
  } else if (line.errors[1] > slope / 3) {
    doubt(critical, "the slope of the line is not known to within a third");
  } else if (line.probability < 0.01) {
    doubt(critical, fmt::format("the yield stresses don't lie on a straight line (probability {:.2g})", line.probability));
  } else if (critical.value > phi.front()) {
    doubt(critical, fmt::format("the line vanishes above {:.3g}, where there is a yield stress", phi.front()));
  }
  return critical;
}

Estimate total_variance(const std::array<Estimate, 3>& parts) {
  Estimate sum{.value = 0, .error = 0, .effective_samples = std::numeric_limits<double>::infinity(), .converged = true};
  for (const Estimate& part : parts) {
    sum.value += part.value;
    sum.error += part.error;
    sum.effective_samples = std::min(sum.effective_samples, part.effective_samples);
    if (!part.converged) doubt(sum, part.reason);
  }
  return sum;
}

Fit gap_radius(const std::vector<RunOutcome>& runs) {
  constexpr double from = 0.2;
  std::vector<statistics::DissipationState> states;
  std::vector<std::string> unconverged;
  for (const RunOutcome& run : runs) {
    Estimate variance = run.velocity_variance;
    variance.value *= run.radius * run.radius;
    variance.error *= run.radius * run.radius;
    const statistics::DissipationState state{.volume_fraction = run.phi_bulk, .shear_rate = 1, .velocity_variance = variance, .relative_viscosity = run.viscosity};
    const Estimate gap = statistics::gap_size(state);
    if (!(run.phi_bulk >= from) || std::isnan(gap.value)) continue;
    states.push_back(state);
    if (!gap.converged) unconverged.push_back(run.directory);
  }
  Fit fit = statistics::fit_gap_radius(states, from);
  if (states.size() < 2) {
    fit.converged = false;
    fit.reason = fmt::format("the gap is known in {} runs with phi of 0.2 and more: two are needed", states.size());
  }
  if (!unconverged.empty()) doubt(fit, fmt::format("gaps aren't converged: {}", fmt::join(unconverged, ", ")));
  return fit;
}

}  // namespace corpuscle::analysis
