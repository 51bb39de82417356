#include "physics/tradeoff.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

namespace corpuscle::tradeoff {
namespace {

using statistics::Estimate;
using statistics::not_a_number;

constexpr std::size_t settings_for_order = 4;  // of a knob: three kernels are no series of resolutions

bool counts(const Point& point, const Deviation& deviation) { return point.cost > 0 && std::isfinite(point.cost) && std::isfinite(deviation.size); }

double median(std::vector<double> values) {
  if (values.empty()) return not_a_number;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

/// The knob in which two points differ, if it's only one.
std::size_t only_difference(const Point& a, const Point& b) {
  std::size_t found = a.settings.size();
  for (std::size_t k = 0; k < a.settings.size(); ++k) {
    if (a.settings[k] == b.settings[k]) continue;
    if (found < a.settings.size()) return a.settings.size();
    found = k;
  }
  return found;
}

std::vector<std::string> without(std::vector<std::string> settings, std::size_t knob) {
  settings[knob].clear();
  return settings;
}

/// Settings of a knob as numbers, ascending; empty when one of them is no number.
std::vector<double> numbers_of(const std::vector<Point>& points, std::size_t knob) {
  std::set<double> numbers;
  for (const Point& p : points) {
    const double number = number_of(p.settings[knob]);
    if (std::isnan(number)) return {};
    numbers.insert(number);
  }
  return {numbers.begin(), numbers.end()};
}

}  // namespace

double number_of(const std::string& setting) {
  double value = 0;
  const auto [end, error] = std::from_chars(setting.data(), setting.data() + setting.size(), value);
  return error == std::errc() && end == setting.data() + setting.size() && !setting.empty() ? value : not_a_number;
}

Estimate mean_of_repeats(const std::vector<Estimate>& repeats) {
  std::vector<const Estimate*> there;
  for (const Estimate& e : repeats)
    if (std::isfinite(e.value)) there.push_back(&e);
  if (there.empty()) return repeats.empty() ? Estimate{.reason = "there is no finished run"} : repeats.front();
  if (there.size() == 1) return *there.front();
  const auto n = static_cast<double>(there.size());
  Estimate mean{.value = 0, .error = 0, .effective_samples = n, .converged = true};
  double own = 0;
  for (const Estimate* e : there) {
    mean.value += e->value / n;
    own += e->error * e->error / (n * n);
    if (!e->converged) doubt(mean, e->reason);
  }
  double scatter = 0;
  for (const Estimate* e : there) scatter += std::pow(e->value - mean.value, 2) / (n * (n - 1));
  mean.error = std::isnan(own) ? std::sqrt(scatter) : std::sqrt(std::max(own, scatter));
  return mean;
}

Deviation deviation(const Point& point, const Reference& reference) {
  Deviation result;
  for (std::size_t i = 0; i < point.observed.size(); ++i) {
    const Estimate &x = point.observed[i], &r = reference.values[i];
    Estimate d{.value = x.value / r.value - 1, .effective_samples = x.effective_samples, .converged = x.converged && r.converged, .reason = x.converged ? r.reason : x.reason};
    const auto known = [](double error) { return std::isfinite(error) ? error : 0; };
    d.error = std::hypot(known(x.error) / r.value, known(r.error) * x.value / (r.value * r.value));
    if (!(r.value != 0)) d = {.reason = "the reference is not known"};
    result.of.push_back(d);
  }
  const auto certain = [&](const Estimate& r) { return r.converged; };
  const bool any = std::any_of(reference.values.begin(), reference.values.end(), certain);
  for (std::size_t i = 0; i < result.of.size(); ++i) {
    if (any && !certain(reference.values[i])) continue;
    const double size = std::abs(result.of[i].value);
    if (std::isnan(size)) {
      result.size = result.uncertainty = not_a_number;
      return result;
    }
    if (!std::isnan(result.size) && size <= result.size) continue;
    result.worst = i;
    result.size = size;
    result.uncertainty = std::abs(result.of[i].error);
  }
  return result;
}

std::vector<std::size_t> pareto_front(const std::vector<Point>& points, const std::vector<Deviation>& deviations) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (counts(points[i], deviations[i])) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return std::pair(points[a].cost, deviations[a].size) < std::pair(points[b].cost, deviations[b].size); });
  std::vector<std::size_t> front;
  for (const std::size_t i : order)
    if (front.empty() || deviations[i].size < deviations[front.back()].size) front.push_back(i);
  return front;
}

std::vector<Order> convergence_orders(const std::vector<Point>& points, const std::vector<Deviation>& deviations, std::size_t knob) {
  std::vector<Order> orders;
  if (numbers_of(points, knob).size() < settings_for_order) return orders;
  std::map<std::vector<std::string>, std::vector<std::size_t>> families;
  for (std::size_t i = 0; i < points.size(); ++i) families[without(points[i].settings, knob)].push_back(i);
  for (const auto& [others, members] : families) {
    const std::size_t observables = points[members.front()].observed.size();
    for (std::size_t observable = 0; observable < observables; ++observable) {
      std::vector<std::array<double, 3>> rows;
      for (const std::size_t i : members) {
        const Estimate& d = deviations[i].of[observable];
        if (std::abs(d.value) > d.error) rows.push_back({number_of(points[i].settings[knob]), std::abs(d.value), d.error});
      }
      if (rows.size() < 3) continue;
      statistics::FitData data{Eigen::VectorXd(rows.size()), Eigen::VectorXd(rows.size()), Eigen::VectorXd(rows.size())};
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        data.x(k) = rows[i][0];
        data.y(k) = rows[i][1];
        data.error(k) = std::max(rows[i][2], 1e-2 * rows[i][1]);  // a power law is no better than that
      }
      orders.push_back({knob, observable, others, rows.size(), statistics::fit_power_law(data)});
    }
  }
  return orders;
}

std::vector<KnobStep> knob_steps(const std::vector<Point>& points, const std::vector<Deviation>& deviations, std::size_t knobs) {
  std::vector<std::vector<double>> numbers(knobs);
  for (std::size_t k = 0; k < knobs; ++k) numbers[k] = numbers_of(points, k);
  const auto neighbours = [&](std::size_t knob, const Point& a, const Point& b) {
    const auto& list = numbers[knob];
    if (list.empty()) return true;
    const auto at = [&](const Point& p) { return std::lower_bound(list.begin(), list.end(), number_of(p.settings[knob])) - list.begin(); };
    return std::abs(at(a) - at(b)) == 1;
  };
  struct Ratios {
    std::vector<double> cost, error;
  };
  std::map<std::tuple<std::size_t, std::string, std::string>, Ratios> steps;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      if (!counts(points[i], deviations[i]) || !counts(points[j], deviations[j])) continue;
      const std::size_t knob = only_difference(points[i], points[j]);
      if (knob >= knobs || !neighbours(knob, points[i], points[j])) continue;
      // One direction for all pairs, so that they can be compared; it is turned below.
      const bool turned = points[j].settings[knob] < points[i].settings[knob];
      const std::size_t a = turned ? j : i, b = turned ? i : j;
      auto& ratios = steps[{knob, points[a].settings[knob], points[b].settings[knob]}];
      ratios.cost.push_back(points[b].cost / points[a].cost);
      ratios.error.push_back(deviations[b].size / std::max(deviations[a].size, 1e-300));
    }
  std::vector<KnobStep> result;
  for (const auto& [key, ratios] : steps) {
    const auto& [knob, a, b] = key;
    KnobStep step{knob, a, b, ratios.cost.size(), median(ratios.cost), median(ratios.error)};
    if (step.cost_factor < 1) step = {knob, b, a, step.pairs, 1 / step.cost_factor, 1 / step.error_factor};
    result.push_back(step);
  }
  std::stable_sort(result.begin(), result.end(), [](const KnobStep& a, const KnobStep& b) {
    const double x = number_of(a.from), y = number_of(b.from);
    return a.knob != b.knob ? a.knob < b.knob : std::isnan(x) || std::isnan(y) ? a.from < b.from : x < y;
  });
  return result;
}

std::vector<Limit> limiting_knobs(const std::vector<Point>& points, const std::vector<Deviation>& deviations, const std::vector<std::size_t>& which) {
  std::vector<Limit> limits;
  for (const std::size_t i : which) {
    Limit best;
    best.point = i;
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (j == i || !counts(points[j], deviations[j])) continue;
      const std::size_t knob = only_difference(points[i], points[j]);
      if (knob >= points[i].settings.size()) continue;
      const double gain = deviations[i].size - deviations[j].size;
      if (gain <= std::hypot(deviations[i].uncertainty, deviations[j].uncertainty) || deviations[j].size >= (std::isnan(best.error) ? deviations[i].size : best.error)) continue;
      best = {i, knob, points[j].settings[knob], deviations[j].size, points[j].cost / points[i].cost};
    }
    if (!std::isnan(best.error)) limits.push_back(best);
  }
  return limits;
}

}  // namespace corpuscle::tradeoff
