#include "physics/statistics/common_limit.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <set>

namespace corpuscle::statistics {
namespace {

constexpr double described = 0.01;          // of a family's range that two terms miss
constexpr double least_relative_error = 1e-6;
constexpr double largest_misfit = 2;        // chi2 per degree of freedom of a family's fit
// Of the way from the finest value to the limit that an extrapolation is uncertain by. With two terms Roache's safety factor of 1.25, which is that much above 1; with one the order isn't known: between 1
// and 1.5 it changes the way by half.
constexpr double beyond = 0.25, beyond_one_term = 0.5;
constexpr double contradiction = 4;         // the same of the families about their mean
constexpr double uncertain = 0.05;          // of the limit

struct SeriesFit {
  double limit = not_a_number, first = 0, second = 0, error = not_a_number, chi2 = not_a_number;
  int points = 0, terms = 0;
  int degrees_of_freedom() const { return points - 1 - terms; }
  double criterion() const { return chi2 + 2.0 * (1 + terms); }
  double misfit() const { return degrees_of_freedom() > 0 ? chi2 / degrees_of_freedom() : 0; }
};

SeriesFit fit(const std::vector<ResolvedValue>& values, int terms) {
  SeriesFit result;
  const auto rows = static_cast<Eigen::Index>(values.size());
  const Eigen::Index columns = 1 + terms;
  if (rows < columns) return result;
  Eigen::MatrixXd design(rows, columns);
  Eigen::VectorXd target(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const auto& v = values[static_cast<std::size_t>(i)];
    const double weight = 1 / v.error;
    for (Eigen::Index k = 0; k < columns; ++k) design(i, k) = weight / std::pow(v.resolution, double(k));
    target(i) = weight * v.value;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(design);
  if (qr.rank() < columns) return result;
  const Eigen::VectorXd solution = qr.solve(target);
  const Eigen::MatrixXd covariance = (design.transpose() * design).ldlt().solve(Eigen::MatrixXd::Identity(columns, columns));
  result.limit = solution(0);
  result.first = terms > 0 ? solution(1) : 0;
  result.second = terms > 1 ? solution(2) : 0;
  result.points = static_cast<int>(rows);
  result.terms = terms;
  result.chi2 = (design * solution - target).squaredNorm();
  result.error = std::sqrt(covariance(0, 0) * std::max(1.0, result.misfit()));
  return result;
}

std::size_t resolutions_of(const std::vector<ResolvedValue>& values) {
  std::set<double> all;
  for (const auto& v : values) all.insert(v.resolution);
  return all.size();
}

/// One term or two. With fewer than four resolutions two would leave nothing to check them with.
SeriesFit best_fit(const std::vector<ResolvedValue>& values) {
  const SeriesFit one = fit(values, 1);
  if (resolutions_of(values) < 4) return one;
  const SeriesFit two = fit(values, 2);
  return one.criterion() <= two.criterion() ? one : two;
}

std::vector<ResolvedValue> without_coarsest(std::vector<ResolvedValue> values) {
  double coarsest = values.front().resolution;
  for (const auto& v : values) coarsest = std::min(coarsest, v.resolution);
  std::erase_if(values, [&](const ResolvedValue& v) { return v.resolution == coarsest; });
  return values;
}

FamilyLimit limit_of(std::vector<ResolvedValue> values) {
  FamilyLimit result;
  result.limit.reason = "fewer than three resolutions were measured";
  if (resolutions_of(values) < 3) return result;
  double low = values.front().value, high = low;
  for (const auto& v : values) low = std::min(low, v.value), high = std::max(high, v.value);
  for (auto& v : values) v.error = std::max({v.error, described * (high - low), least_relative_error * std::abs(v.value), 1e-300});
  SeriesFit found = best_fit(values);
  while (found.misfit() > largest_misfit && resolutions_of(values) > 3) {
    values = without_coarsest(values);
    found = best_fit(values);
  }
  if (std::isnan(found.limit)) return result;
  const SeriesFit finer = fit(without_coarsest(values), resolutions_of(values) > 4 ? found.terms : 1);
  double from = values.front().resolution;
  for (const auto& v : values) from = std::min(from, v.resolution);
  result = {{.value = found.limit, .effective_samples = double(found.points), .converged = true}, from, found.first, found.second, found.error, std::abs(finer.limit - found.limit)};
  const auto finest = std::max_element(values.begin(), values.end(), [](const ResolvedValue& a, const ResolvedValue& b) { return a.resolution < b.resolution; });
  const double r = finest->resolution, way = std::abs(found.first / r + found.second / (r * r));
  result.model_error = std::hypot(std::isnan(result.model_error) ? 0 : result.model_error, (found.terms > 1 ? beyond : beyond_one_term) * way);
  result.limit.error = std::hypot(result.statistical_error, result.model_error);
  return result;
}

}  // namespace

CommonLimit common_limit(const std::vector<ResolvedValue>& values) {
  CommonLimit result;
  int families = 0;
  for (const auto& v : values) families = std::max(families, v.family + 1);
  double weights = 0, sum = 0;
  int used = 0;
  for (int f = 0; f < families; ++f) {
    std::vector<ResolvedValue> own;
    std::copy_if(values.begin(), values.end(), std::back_inserter(own), [&](const ResolvedValue& v) {
      return v.family == f && v.resolution > 0 && std::isfinite(v.resolution) && std::isfinite(v.value) && std::isfinite(v.error);
    });
    result.families.push_back(limit_of(own));
    const Estimate& limit = result.families.back().limit;
    if (!(limit.error > 0)) {
      if (limit.converged) result.families.back().limit.error = least_relative_error * std::abs(limit.value);
      else continue;
    }
    const double weight = 1 / (limit.error * limit.error);
    weights += weight;
    sum += weight * limit.value;
    ++used;
  }
  if (used == 0) {
    result.limit.reason = "no settings were measured at three resolutions";
    return result;
  }
  result.limit = {.value = sum / weights, .error = 1 / std::sqrt(weights), .effective_samples = double(used), .converged = true};
  result.chi2 = 0;
  for (const FamilyLimit& family : result.families)
    if (family.limit.error > 0) result.chi2 += std::pow((family.limit.value - result.limit.value) / family.limit.error, 2);
  result.degrees_of_freedom = used - 1;
  const double scatter = used > 1 ? result.chi2 / (used - 1) : 0;
  result.limit.error *= std::sqrt(std::max(1.0, scatter));
  if (scatter > contradiction)
    doubt(result.limit, fmt::format("the families contradict each other (chi2 = {:.3g} for {} degrees of freedom): finer resolutions are needed", result.chi2, result.degrees_of_freedom));
  if (result.limit.error > uncertain * std::abs(result.limit.value))
    doubt(result.limit, fmt::format("its error is {:.1f} %: finer resolutions, or more or longer runs, are needed", 100 * result.limit.error / std::abs(result.limit.value)));
  return result;
}

}  // namespace corpuscle::statistics
