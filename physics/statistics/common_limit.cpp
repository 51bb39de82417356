#include "physics/statistics/common_limit.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>

namespace corpuscle::statistics {
namespace {

constexpr double least_relative_error = 1e-3;
constexpr std::size_t resolutions_for_two_terms = 4;
constexpr double largest_misfit = 2;  // chi2 per degree of freedom

struct LinearFit {
  double limit = not_a_number, error = not_a_number, chi2 = not_a_number;
  int degrees_of_freedom = 0;
  std::map<int, CommonLimit::Terms> terms;
};

std::map<int, std::set<double>> resolutions_of(const std::vector<ResolvedValue>& values) {
  std::map<int, std::set<double>> result;
  for (const auto& v : values) result[v.family].insert(v.resolution);
  return result;
}

/// Families with one resolution say nothing about the limit.
std::vector<ResolvedValue> usable(const std::vector<ResolvedValue>& values) {
  std::vector<ResolvedValue> result;
  std::copy_if(values.begin(), values.end(), std::back_inserter(result),
               [](const ResolvedValue& v) { return v.resolution > 0 && std::isfinite(v.resolution) && std::isfinite(v.value) && std::isfinite(v.error); });
  const auto resolutions = resolutions_of(result);
  std::erase_if(result, [&](const ResolvedValue& v) { return resolutions.at(v.family).size() < 2; });
  return result;
}

LinearFit fit(const std::vector<ResolvedValue>& values, const std::map<int, std::size_t>& terms_of) {
  LinearFit result;
  Eigen::Index columns = 1;
  std::map<int, Eigen::Index> first_column;
  for (const auto& [family, terms] : terms_of) {
    first_column[family] = columns;
    columns += static_cast<Eigen::Index>(terms);
  }
  const auto rows = static_cast<Eigen::Index>(values.size());
  if (rows < columns) return result;
  Eigen::MatrixXd design = Eigen::MatrixXd::Zero(rows, columns);
  Eigen::VectorXd target(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const auto& v = values[static_cast<std::size_t>(i)];
    const double weight = 1 / std::max({v.error, least_relative_error * std::abs(v.value), 1e-300});
    design(i, 0) = weight;
    for (std::size_t k = 0; k < terms_of.at(v.family); ++k) design(i, first_column[v.family] + static_cast<Eigen::Index>(k)) = weight / std::pow(v.resolution, double(k + 1));
    target(i) = weight * v.value;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(design);
  if (qr.rank() < columns) return result;
  const Eigen::VectorXd solution = qr.solve(target);
  const Eigen::MatrixXd covariance = (design.transpose() * design).ldlt().solve(Eigen::MatrixXd::Identity(columns, columns));
  result.limit = solution(0);
  result.chi2 = (design * solution - target).squaredNorm();
  result.degrees_of_freedom = static_cast<int>(rows - columns);
  const double scatter = result.degrees_of_freedom > 0 ? std::max(1.0, result.chi2 / result.degrees_of_freedom) : 1;
  result.error = std::sqrt(covariance(0, 0) * scatter);
  for (const auto& [family, terms] : terms_of) {
    const Eigen::Index c = first_column[family];
    result.terms[family] = {solution(c), terms > 1 ? solution(c + 1) : 0};
  }
  return result;
}

std::map<int, std::size_t> terms_for(const std::vector<ResolvedValue>& values) {
  std::map<int, std::size_t> terms;
  for (const auto& [family, resolutions] : resolutions_of(values)) terms[family] = resolutions.size() >= resolutions_for_two_terms ? 2 : 1;
  return terms;
}

}  // namespace

CommonLimit common_limit(const std::vector<ResolvedValue>& all) {
  CommonLimit result;
  int families = 0;
  for (const auto& v : all) families = std::max(families, v.family + 1);
  result.terms.resize(static_cast<std::size_t>(families));
  std::set<double> resolutions;
  for (const auto& v : usable(all)) resolutions.insert(v.resolution);
  if (resolutions.empty()) {
    result.limit.reason = "no settings were measured at two resolutions";
    return result;
  }
  // Coarse resolutions are left out until the model holds; else the range where it holds best is taken.
  struct Range {
    double from = 0;
    LinearFit fit;
  };
  std::vector<Range> ranges;
  for (const double from : resolutions) {
    std::vector<ResolvedValue> values = all;
    std::erase_if(values, [&](const ResolvedValue& v) { return v.resolution < from; });
    values = usable(values);
    if (values.empty()) break;
    LinearFit found = fit(values, terms_for(values));
    if (!std::isnan(found.limit)) ranges.push_back({from, std::move(found)});
  }
  if (ranges.empty()) {
    result.limit.reason = "the resolutions do not determine the limit";
    return result;
  }
  const auto misfit = [](const Range& range) { return range.fit.degrees_of_freedom > 0 ? range.fit.chi2 / range.fit.degrees_of_freedom : std::numeric_limits<double>::infinity(); };
  auto chosen = std::find_if(ranges.begin(), ranges.end(), [&](const Range& range) { return misfit(range) <= largest_misfit; });
  const bool holds = chosen != ranges.end();
  if (!holds) chosen = std::min_element(ranges.begin(), ranges.end(), [&](const Range& a, const Range& b) { return misfit(a) < misfit(b); });

  result.from = chosen->from;
  result.statistical_error = chosen->fit.error;
  result.chi2 = chosen->fit.chi2;
  result.degrees_of_freedom = chosen->fit.degrees_of_freedom;
  for (const auto& [family, t] : chosen->fit.terms) result.terms[static_cast<std::size_t>(family)] = t;
  result.limit.value = chosen->fit.limit;
  result.limit.effective_samples = static_cast<double>(std::count_if(all.begin(), all.end(), [&](const ResolvedValue& v) { return v.resolution >= result.from; }));
  result.limit.converged = true;
  if (std::next(chosen) != ranges.end()) result.model_error = std::abs(std::next(chosen)->fit.limit - chosen->fit.limit);
  result.limit.error = std::hypot(result.statistical_error, std::isnan(result.model_error) ? 0 : result.model_error);
  if (!holds) doubt(result.limit, fmt::format("the points scatter more about the extrapolation than their errors allow (chi2 = {:.3g} for {} degrees of freedom): finer resolutions, or more "
                                              "terms, are needed", result.chi2, result.degrees_of_freedom));
  if (std::isnan(result.model_error)) doubt(result.limit, "no finer resolutions are left that could confirm the extrapolation");
  if (result.model_error > 0.05 * std::abs(result.limit.value))
    doubt(result.limit, fmt::format("without the coarsest resolution the limit is {:.2g} away: finer ones are needed", result.model_error));
  return result;
}

}  // namespace corpuscle::statistics
