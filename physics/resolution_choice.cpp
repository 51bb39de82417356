#include "physics/resolution_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "core/error.hpp"

namespace corpuscle {
namespace {

/// Time of a vertex over that of a node, with 2, 3 and 4 points: the coupled steps of docs/performance.md (section "A coupled step", phi = 0.36, float).
constexpr std::array<double, 3> vertex_cost{8.7, 9.2, 10};

}  // namespace

double resolution_cost(const Problem& problem, const LatticeParameters& lattice) {
  const double vertices = vertex_cost.at(std::size_t(problem.accuracy.delta_kernel - 2)) * double(lattice.vertices()) / lattice.coupling_every;
  return lattice.steps_per_strain * (lattice.box_volume() + vertices);
}

std::vector<ResolutionChoice> resolution_choices(const Problem& problem) {
  std::set<std::pair<double, int>> measured;
  for (const MeasuredDeviation& m : measured_deviations())
    if (m.counted == counted_by(problem)) measured.emplace(m.radius, m.delta_kernel);
  std::vector<ResolutionChoice> choices;
  if (problem.cells.size() != 1) return choices;  // nothing was measured; and a lattice of a thousand types takes a while
  for (const auto& [radius, delta_kernel] : measured) {
    Problem tried = problem;
    tried.accuracy.radius = radius;
    tried.accuracy.delta_kernel = delta_kernel;
    tried.accuracy.subdivision.reset();
    try {
      const LatticeParameters lattice = to_lattice(tried);
      const ResolutionError error = viscosity_resolution_error(tried, lattice);
      if (error.known()) choices.push_back({radius, delta_kernel, error, resolution_cost(tried, lattice), std::abs(error.value) + error.uncertainty});
    } catch (const InputError&) {  // no setting for this scene
    }
  }
  std::map<int, double> largest;  // by kernel; `measured` is in the order of the radius
  for (auto choice = choices.rbegin(); choice != choices.rend(); ++choice) {
    double& bound = largest[choice->delta_kernel];
    choice->bound = bound = std::max(bound, choice->bound);
  }
  std::stable_sort(choices.begin(), choices.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
  return choices;
}

std::vector<ResolutionChoice> worthwhile(const std::vector<ResolutionChoice>& choices) {
  std::vector<ResolutionChoice> front;
  for (const auto& choice : choices)
    if (front.empty() || choice.bound < front.back().bound) front.push_back(choice);
  return front;
}

void choose_resolution(Problem& problem, double target, std::optional<double> radius, std::optional<int> delta_kernel) {
  std::vector<ResolutionChoice> choices = resolution_choices(problem);
  if (choices.empty()) {
    const std::string reason = viscosity_resolution_error(problem, to_lattice(problem)).reason;
    throw InputError(fmt::format("accuracy.target = {:g}: what the resolution does to the viscosity isn't known here: {}; remove it, and give accuracy.radius and accuracy.delta_kernel", target, reason));
  }
  std::erase_if(choices, [&](const auto& c) { return (radius && c.radius != *radius) || (delta_kernel && c.delta_kernel != *delta_kernel); });
  if (choices.empty())
    throw InputError(fmt::format("accuracy.target = {:g}: no study has {} = {:g}; remove one of both", target, radius ? "accuracy.radius" : "accuracy.delta_kernel", radius ? *radius : *delta_kernel));
  const auto chosen = std::find_if(choices.begin(), choices.end(), [&](const auto& c) { return c.bound <= target; });
  if (chosen == choices.end()) {
    const auto& best = *std::min_element(choices.begin(), choices.end(), [](const auto& a, const auto& b) { return a.bound < b.bound; });
    throw InputError(fmt::format("accuracy.target = {:g} is beyond what was measured ({}): the best is {:+.1f} ± {:.1f} %, with radius = {:g} and delta_kernel = {}; give at least {:.3f}, or radius and delta_kernel",
                                 target, best.error.reason, 100 * best.error.value, 100 * best.error.uncertainty, best.radius, best.delta_kernel, std::ceil(1000 * best.bound) / 1000));
  }
  problem.accuracy.radius = chosen->radius;
  problem.accuracy.delta_kernel = chosen->delta_kernel;
}

}  // namespace corpuscle
