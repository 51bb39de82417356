#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "physics/statistics/histogram.hpp"

namespace corpuscle::statistics {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Integral of the model over a bin [low, high], for parameters p.
using BinIntegral = std::function<double(double low, double high, const VectorXd& p)>;

double gaussian_integral(double low, double high, double centre, double width) {
  const double scale = 1 / (std::numbers::sqrt2 * width);
  return std::sqrt(std::numbers::pi / 2) * width * (std::erf((high - centre) * scale) - std::erf((low - centre) * scale));
}

// Signed square root of the Poisson deviance: the sum of its squares is -2 ln(likelihood) up to a constant.
double deviance_root(double counted, double expected) {
  expected = std::max(expected, 1e-300);
  const double log_part = counted > 0 ? counted * std::log(counted / expected) : 0;
  return std::copysign(std::sqrt(std::max(2 * (expected - counted + log_part), 0.0)), counted - expected);
}

// Fit of the bins [first, first + counts.size()).
Fit fit_counts(const Histogram& histogram, Index first, const VectorXd& counts, double samples, const BinIntegral& integral, const FitProblem& problem) {
  const Residuals residuals = [&](const VectorXd& p) {
    VectorXd r(counts.size());
    for (Index i = 0; i < r.size(); ++i) r[i] = deviance_root(counts[i], samples * integral(histogram.edges[first + i], histogram.edges[first + i + 1], p));
    return r;
  };
  return least_squares(residuals, problem);
}

Fit refused(std::vector<std::string> names, std::string reason) {
  Fit fit;
  const auto n = static_cast<Index>(names.size());
  fit.names = std::move(names);
  fit.parameters = fit.errors = VectorXd::Constant(n, not_a_number);
  fit.covariance = Eigen::MatrixXd::Constant(n, n, not_a_number);
  fit.reason = std::move(reason);
  return fit;
}

// The fit of bins first ... last-1 of all blocks, with errors from resampling them. `start_for` gives the problem for given counts.
template <class StartFor>
Fit fit_bins(const Histogram& histogram, Index first, Index last, const BinIntegral& integral, const StartFor& start_for, const std::vector<std::string>& names,
             const Resampling& resampling) {
  if (last - first < static_cast<Index>(names.size())) {
    return refused(names, fmt::format("{} bins are too few for {} parameters", std::max<Index>(last - first, 0), names.size()));
  }
  const auto with_weights = [&](const VectorXd& weights) {
    const VectorXd counts = histogram.counts.middleRows(first, last - first) * weights;
    const double found = counts.sum(), samples = histogram.samples.dot(weights);
    if (found < 20) return refused(names, fmt::format("{:g} samples in this range are too few for a fit (at least 20)", found));
    return fit_counts(histogram, first, counts, samples, integral, start_for(counts, samples));
  };
  Fit fit = with_weights(VectorXd::Ones(histogram.counts.cols()));
  if (!fit.converged) return fit;
  const Resampled resampled = bootstrap(
      histogram.counts.cols(),
      [&](const VectorXd& weights) {
        const Fit trial = with_weights(weights);
        return trial.converged ? trial.parameters : VectorXd::Constant(fit.parameters.size(), not_a_number).eval();
      },
      resampling);
  fit.errors = resampled.error;
  fit.covariance = resampled.covariance;
  if (histogram.counts.cols() < blocks_to_trust) {
    fit.converged = false;
    fit.reason = fmt::format("{} blocks are too few for an error (at least {})", histogram.counts.cols(), blocks_to_trust);
  } else if (10 * resampled.failed > resampling.resamples) {
    fit.converged = false;
    fit.reason = fmt::format("the fit failed for {} of {} resamples of the data", resampled.failed, resampling.resamples);
  }
  return fit;
}

}  // namespace

CoreAndTails fit_core_and_tails(const Histogram& histogram, double core_reach, double tail_start, const Resampling& resampling) {
  const std::vector<std::string> core_names{"height", "centre", "width"}, tail_names{"height", "decay"};
  CoreAndTails result;
  std::string reason = histogram.reason;
  if (reason.empty() && histogram.counts.sum() == 0) reason = "there is no sample in the bins";
  if (!reason.empty()) {
    result.core = refused(core_names, reason);
    result.lower = result.upper = refused(tail_names, reason);
    return result;
  }
  const VectorXd centres = histogram.centres(), all = histogram.counts.rowwise().sum();
  const double mean = centres.dot(all) / all.sum();
  const double deviation = std::sqrt((centres.array() - mean).square().matrix().dot(all) / all.sum());
  const Index bins = centres.size();
  // Edges of bins nearest to the wanted limits: ranges consist of whole bins.
  const auto edge_at = [&](double x) { return std::clamp<Index>(std::lround((x - histogram.edges[0]) / histogram.width()), 0, bins); };

  result.core = fit_bins(
      histogram, edge_at(mean - core_reach * deviation), edge_at(mean + core_reach * deviation),
      [](double low, double high, const VectorXd& p) { return p[0] * gaussian_integral(low, high, p[1], p[2]); },
      [&](const VectorXd& counts, double samples) {
        FitProblem problem{.names = core_names, .start = VectorXd(3), .positive = {true, false, true}};
        problem.start << counts.maxCoeff() / (samples * histogram.width()), mean + 0.01 * deviation, deviation;
        return problem;
      },
      core_names, resampling);

  const auto tail = [&](Index first, Index last, double from, double sign) {
    return fit_bins(
        histogram, first, last,
        [=](double low, double high, const VectorXd& p) {
          const double near = sign > 0 ? low - from : from - high, far = sign > 0 ? high - from : from - low;
          return p[0] * p[1] * (std::exp(-near / p[1]) - std::exp(-far / p[1]));
        },
        [&, first](const VectorXd& counts, double samples) {
          // The mean distance from the start of the tail is the decay's maximum-likelihood value without bins.
          double distance = 0;
          for (Index i = 0; i < counts.size(); ++i) distance += counts[i] * std::abs(centres[first + i] - from);
          distance /= counts.sum();
          FitProblem problem{.names = tail_names, .start = VectorXd(2), .positive = {true, true}};
          problem.start << counts.sum() / (samples * distance), distance;
          return problem;
        },
        tail_names, resampling);
  };
  const Index low = edge_at(mean - tail_start * deviation), high = edge_at(mean + tail_start * deviation);
  result.lower_start = histogram.edges[low];
  result.upper_start = histogram.edges[high];
  result.lower = tail(0, low, result.lower_start, -1);
  result.upper = tail(high, bins, result.upper_start, 1);

  const double found = all.head(low).sum() + all.tail(bins - high).sum();
  if (result.core.converged && found > 0) {
    const double centre = result.core.parameters[1], width = result.core.parameters[2], scale = 1 / (std::numbers::sqrt2 * width);
    const double both = std::erfc((centre - result.lower_start) * scale) + std::erfc((result.upper_start - centre) * scale);
    const double expected = result.core.parameters[0] * std::sqrt(std::numbers::pi / 2) * width * both * histogram.samples.sum();
    result.gaussian_tail = expected / found;
  }
  return result;
}

}  // namespace corpuscle::statistics
