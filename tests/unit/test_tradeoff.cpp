// Error against cost: deviations, the front, orders, steps and limiting knobs of made-up points.
#include <cmath>

#include "physics/tradeoff.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;
using namespace corpuscle::tradeoff;
using statistics::Estimate;

namespace {

Estimate value(double x, double error = 0) { return {.value = x, .error = error, .converged = true}; }

struct Made {
  std::vector<Point> points;
  Reference reference{{value(2)}};
  std::vector<Deviation> deviations() const {
    std::vector<Deviation> list;
    for (const Point& p : points) list.push_back(deviation(p, reference));
    return list;
  }
};

/// Knobs: radius, kernel. Deviation 1/r^2 with "a", half of that with "b"; cost r^5 with "a", twice that with "b".
Made grid() {
  Made made;
  for (const int r : {3, 4, 6, 8})
    for (const char* kernel : {"a", "b"}) {
      const bool b = kernel[0] == 'b';
      made.points.push_back({std::to_string(r) + kernel, {std::to_string(r), kernel}, {value(2 * (1 + (b ? 0.5 : 1) / (r * r)), 1e-4)}, (b ? 2.0 : 1.0) * std::pow(r, 5)});
    }
  return made;
}

}  // namespace

TEST_CASE("tradeoff: deviations with both uncertainties", "[tradeoff]") {
  const Reference reference{{value(2, 0.02), value(-4, 0)}};
  const Deviation d = deviation({"p", {}, {value(2.2, 0.03), value(-4.1, 0.4)}, 1}, reference);
  CHECK(d.of[0].value == Approx(0.1));
  CHECK(d.of[0].error == Approx(std::hypot(0.015, 0.011)));
  CHECK(d.of[1].value == Approx(0.025));
  CHECK(std::abs(d.of[1].error) == Approx(0.1));
  CHECK(d.worst == 0);
  CHECK(d.size == Approx(0.1));
  // One observable is missing: the point can't be judged.
  CHECK(std::isnan(deviation({"p", {}, {value(2.2), Estimate{.reason = "none"}}, 1}, reference).size));
  CHECK(std::isnan(deviation({"p", {}, {value(1)}, 1}, {{value(0)}}).size));
}

TEST_CASE("tradeoff: the front has no point that a cheaper one equals", "[tradeoff]") {
  Made made;
  const double numbers[][2] = {{1, 0.3}, {2, 0.3}, {3, 0.1}, {3, 0.2}, {5, 0.15}, {9, 0.01}};
  for (const auto& [cost, error] : numbers) made.points.push_back({"", {}, {value(2 * (1 + error))}, cost});
  made.points.push_back({"", {}, {value(2)}, std::nan("")});
  made.points.push_back({"", {}, {Estimate{}}, 0.5});
  CHECK(pareto_front(made.points, made.deviations()) == std::vector<std::size_t>{0, 2, 5});
}

TEST_CASE("tradeoff: orders of convergence", "[tradeoff]") {
  Made made = grid();
  auto orders = convergence_orders(made.points, made.deviations(), 0);
  REQUIRE(orders.size() == 2);
  for (const auto& order : orders) {
    CHECK(order.points == 4);
    CHECK(order.fit.parameter("exponent").value == Approx(-2).epsilon(1e-6));
    CHECK(order.others[0].empty());
  }
  CHECK(convergence_orders(made.points, made.deviations(), 1).empty());
  // What is within its uncertainty says nothing.
  for (Point& p : made.points) p.observed[0].error = 1;
  CHECK(convergence_orders(made.points, made.deviations(), 0).empty());
}

TEST_CASE("tradeoff: what a step of a knob buys", "[tradeoff]") {
  const Made made = grid();
  const auto steps = knob_steps(made.points, made.deviations(), 2);
  REQUIRE(steps.size() == 4);
  CHECK(steps[0].from == "3");
  CHECK(steps[0].to == "4");
  CHECK(steps[0].pairs == 2);
  CHECK(steps[0].cost_factor == Approx(std::pow(4.0 / 3, 5)));
  CHECK(steps[0].error_factor == Approx(9.0 / 16));
  CHECK(steps[2].from == "6");
  CHECK(steps[3].knob == 1);
  CHECK(steps[3].from == "a");
  CHECK(steps[3].pairs == 4);
  CHECK(steps[3].cost_factor == Approx(2));
  CHECK(steps[3].error_factor == Approx(0.5));
}

TEST_CASE("tradeoff: the knob that limits a point", "[tradeoff]") {
  Made made = grid();
  const auto limits = limiting_knobs(made.points, made.deviations(), {0, 7});
  // From 3a the finest radius helps most; nothing is better than 8b.
  REQUIRE(limits.size() == 1);
  CHECK(limits[0].point == 0);
  CHECK(limits[0].knob == 0);
  CHECK(limits[0].to == "8");
  CHECK(limits[0].cost_factor == Approx(std::pow(8.0 / 3, 5)));
  for (Point& p : made.points) p.observed[0].error = 0.5;
  CHECK(limiting_knobs(made.points, made.deviations(), {0, 7}).empty());
}

TEST_CASE("tradeoff: means of repeats", "[tradeoff]") {
  const Estimate wide = mean_of_repeats({value(1, 0.01), value(3, 0.01)});
  CHECK(wide.value == 2);
  CHECK(wide.error == Approx(1));  // their scatter is larger than their errors
  const Estimate narrow = mean_of_repeats({value(1, 0.4), value(1.1, 0.3), Estimate{.reason = "gone"}});
  CHECK(narrow.value == Approx(1.05));
  CHECK(narrow.error == Approx(0.25));
  CHECK(narrow.converged);
  CHECK(mean_of_repeats({}).reason.find("no finished run") != std::string::npos);
  CHECK(mean_of_repeats({Estimate{.reason = "why"}}).reason == "why");
}

TEST_CASE("tradeoff: settings as numbers", "[tradeoff]") {
  CHECK(number_of("6") == 6);
  CHECK(number_of("2.5e-3") == 0.0025);
  for (const char* text : {"", "mesh", "6 nodes", "[6,6]"}) CHECK(std::isnan(number_of(text)));
}
