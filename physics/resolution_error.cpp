#include "physics/resolution_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

namespace corpuscle {
namespace {

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

ResolutionError unknown(std::string reason) { return {not_known, not_known, std::move(reason)}; }

struct Value {
  double value = not_known, uncertainty = not_known;
};

/// Linear in `x` between two measured values.
Value between(double x, double x0, const Value& a, double x1, const Value& b) {
  const double t = x1 == x0 ? 0 : (x - x0) / (x1 - x0);
  return {(1 - t) * a.value + t * b.value, (1 - t) * a.uncertainty + t * b.uncertainty};
}

/// Along the radius. Beyond the finest one a deviation falls as 1/radius at least.
Value at_radius(const std::map<double, Value>& measured, double radius) {
  if (measured.empty() || radius < measured.begin()->first) return {};
  const auto above = measured.lower_bound(radius);
  if (above == measured.end()) {
    const auto& [finest, v] = *measured.rbegin();
    return {v.value * finest / radius, v.uncertainty};
  }
  if (above->first == radius) return above->second;
  const auto below = std::prev(above);
  return between(1 / radius, 1 / below->first, below->second, 1 / above->first, above->second);
}

/// Why the studies say nothing about a scene; empty when they do.
std::string not_measured(const Problem& p, const LatticeParameters& l) {
  if (p.cells.empty()) return "there are no cells";
  if (p.flow.kind != FlowKind::shear || !p.box.walls) return "it was measured in shear between walls";
  if (p.cells.size() > 1 || p.cells[0].shape != ShapeKind::red_cell) return "it was measured for red cells of one type";
  if (p.cells[0].count == 1) return "it was measured for suspensions";
  if (p.accuracy.shell_thickness) return "it was measured with the default accuracy.shell_thickness";
  const double lambda = p.accuracy.collision == CollisionKind::trt ? p.accuracy.magic_parameter : std::pow(l.relaxation_time - 0.5, 2);
  if (lambda < 0.15 || lambda > 0.3) return "it was measured with TRT (magic_parameter = 0.1875), from which BGK at this relaxation time differs";
  return {};
}

}  // namespace

const char* name_of(CountedBy counted) {
  switch (counted) {
    case CountedBy::mesh: return "mesh volume or number";
    case CountedBy::viscosity_shell: return "effective volume";
    case CountedBy::drag_shell: return "effective volume with the shell of the drag";
    default: return "nominal volume";
  }
}

CountedBy counted_by(const Problem& problem) {
  if (problem.accuracy.cell_size == CellSize::hydrodynamic) return CountedBy::hydrodynamic;
  if (problem.cells.empty() || !problem.cells[0].effective_volume_fraction) return CountedBy::mesh;
  return problem.accuracy.counted_shell == CountedShell::drag ? CountedBy::drag_shell : CountedBy::viscosity_shell;
}

double counted_fraction(const Problem& problem, const LatticeParameters& lattice) {
  const CountedBy counted = counted_by(problem);
  return counted == CountedBy::viscosity_shell || counted == CountedBy::drag_shell ? lattice.phi_effective : lattice.phi_nominal;
}

ResolutionError viscosity_resolution_error(const Problem& problem, const LatticeParameters& lattice) {
  if (const std::string reason = not_measured(problem, lattice); !reason.empty()) return unknown(reason);
  const CountedBy counted = counted_by(problem);
  const double phi = counted_fraction(problem, lattice);
  std::map<double, std::map<double, Value>> measured;  // by phi and radius
  for (const MeasuredDeviation& m : measured_deviations())
    if (m.counted == counted && m.delta_kernel == problem.accuracy.delta_kernel) measured[m.phi][m.radius] = {m.deviation, m.uncertainty};

  const std::string settings = fmt::format("counted by {}, {}-point kernel", name_of(counted), problem.accuracy.delta_kernel);
  std::vector<std::pair<double, Value>> rows{{0.0, {0, 0}}};
  for (const auto& [fraction, by_radius] : measured) {
    const Value v = at_radius(by_radius, problem.accuracy.radius);
    if (!std::isnan(v.value)) rows.emplace_back(fraction, v);
  }
  if (rows.size() == 1) return unknown(fmt::format("no study has red cells {} at r = {:g}", settings, problem.accuracy.radius));
  // A hundredth beyond the largest fraction is the rounding of a number of cells.
  const double largest = rows.back().first;
  if (phi > 1.03 * largest) return unknown(fmt::format("phi = {:.3g} is beyond the {:g} that was measured for red cells {} at r = {:g}", phi, largest, settings, problem.accuracy.radius));
  auto above = std::find_if(rows.begin(), rows.end(), [&](const auto& row) { return row.first >= phi; });
  if (above == rows.end()) above = std::prev(rows.end());
  if (above == rows.begin()) ++above;
  const auto below = std::prev(above);
  const Value v = between(std::min(phi, largest), below->first, below->second, above->first, above->second);
  return {v.value, v.uncertainty, fmt::format("red cells {}, r = {:g}, phi = {:.3g}, Ca = 0.08", settings, problem.accuracy.radius, phi)};
}

}  // namespace corpuscle
