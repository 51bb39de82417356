// Error against cost of simulations that differ in their settings: which settings are worth their price (docs/tradeoff.md). Numbers only: who ran them, and where they are kept, is
// no business of this file.
#pragma once
#include <string>
#include <vector>

#include "physics/statistics/common_limit.hpp"
#include "physics/statistics/fit.hpp"

namespace corpuscle::tradeoff {

/// Settings of a scene that were tried. Repeats with other seeds are one point.
struct Point {
  std::string name;
  std::vector<std::string> settings;               ///< of each knob
  std::vector<statistics::Estimate> observed;      ///< of each observable; NaN where there is nothing
  double cost = statistics::not_a_number;          ///< core seconds a unit of strain
};

/// What the errors are about, for each observable.
struct Reference {
  std::vector<statistics::Estimate> values;
};

/// Deviations of a point: value/reference - 1 of each observable, the error being that of point and reference together.
struct Deviation {
  std::vector<statistics::Estimate> of;
  std::size_t worst = 0;     ///< the observable that deviates most, of those with a reference that is certain where there are any
  double size = statistics::not_a_number;         ///< |deviation| of that one; NaN when an observable is missing
  double uncertainty = statistics::not_a_number;
};

Deviation deviation(const Point& point, const Reference& reference);

/// Points that no cheaper one, or equally cheap one, equals in accuracy, by cost. Points without a cost or a deviation are no part of it.
std::vector<std::size_t> pareto_front(const std::vector<Point>& points, const std::vector<Deviation>& deviations);

/// How the deviation of an observable falls along a knob whose settings are numbers, all other knobs being the same: |deviation| = prefactor setting^-order.
struct Order {
  std::size_t knob = 0, observable = 0;
  std::vector<std::string> others;  ///< settings of the other knobs; that of the knob itself is empty
  std::size_t points = 0;           ///< that deviate by more than their uncertainty; the others are left out
  statistics::Fit fit;              ///< prefactor, exponent (= -order)
};
/// For every family with three or more such points, along a knob with four or more settings.
std::vector<Order> convergence_orders(const std::vector<Point>& points, const std::vector<Deviation>& deviations, std::size_t knob);

/// What a step from one setting of a knob to another does to cost and deviation, all other knobs being the same: the medians over all such pairs.
struct KnobStep {
  std::size_t knob = 0;
  std::string from, to;       ///< `to` is the dearer one
  std::size_t pairs = 0;
  double cost_factor = statistics::not_a_number, error_factor = statistics::not_a_number;
};
/// Between neighbouring settings for knobs of numbers, between all of them otherwise.
std::vector<KnobStep> knob_steps(const std::vector<Point>& points, const std::vector<Deviation>& deviations, std::size_t knobs);

/// The change of one knob that takes most of a point's deviation away.
struct Limit {
  std::size_t point = 0;
  std::size_t knob = 0;
  std::string to;
  double error = statistics::not_a_number;        ///< deviation after it
  double cost_factor = statistics::not_a_number;
};
/// Of each of `which`, where one of the other points is one knob away and better by more than both uncertainties.
std::vector<Limit> limiting_knobs(const std::vector<Point>& points, const std::vector<Deviation>& deviations, const std::vector<std::size_t>& which);

/// The mean of repeats: errors from their own, or from their scatter where that is larger. Those without a value are left out.
statistics::Estimate mean_of_repeats(const std::vector<statistics::Estimate>& repeats);

/// A setting as a number; NaN when it is none.
double number_of(const std::string& setting);

}  // namespace corpuscle::tradeoff
