// Deformation, orientation and motion of the cells.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "physics/analysis/groups.hpp"
#include "physics/statistics/ellipsoid.hpp"
#include "physics/statistics/mean_error.hpp"
#include "physics/statistics/orientation.hpp"
#include "physics/statistics/tumbling.hpp"

namespace corpuscle::analysis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double motion_window = 11;  // strain: half a period of a rigid disc of a red cell's aspect takes 10.7 (Jeffery)

struct Ellipsoids {
  MatrixXd deformation, inclination, x, y, z;  // [times][cells]; the last three: the shortest axis
};

Ellipsoids ellipsoids_of(const SteadyState& state) {
  const MatrixXd none = MatrixXd::Constant(state.times, state.record.cells->cells(), statistics::not_a_number);
  Ellipsoids result{none, none, none, none, none};
  state.record.cells->visit(CellQuantity::gyration, state.first, [&](Index time, std::span<const double> values) {
    const Index t = time - state.first;
    std::array<double, 6> gyration{};
    for (Index cell = 0; cell < none.cols(); ++cell) {
      std::copy_n(&values[6 * static_cast<std::size_t>(cell)], 6, gyration.begin());
      if (!std::all_of(gyration.begin(), gyration.end(), [](double g) { return std::isfinite(g); })) continue;
      const auto fit = statistics::fit_ellipsoid(gyration);
      result.deformation(t, cell) = fit.deformation;
      result.inclination(t, cell) = fit.inclination;
      result.x(t, cell) = fit.symmetry_axis[0];
      result.y(t, cell) = fit.symmetry_axis[1];
      result.z(t, cell) = fit.symmetry_axis[2];
    }
  });
  return result;
}

// Cells count in windows that they spend in the bulk from end to end: one that leaves has no time to turn.
void keep_whole_windows(const SteadyState& state, Index length, Ellipsoids& axes) {
  for (Index cell = 0; cell < axes.x.cols(); ++cell) {
    for (Index from = 0; from + length < state.times; from += length) {
      bool stays = true;
      for (Index t = from; t <= from + length && stays; ++t) stays = std::isnan(state.heights(t, cell)) || !std::isnan(state.inside(t, cell));
      if (!stays) axes.x.col(cell).segment(from, length + 1).setConstant(statistics::not_a_number);
    }
  }
}

void add_motion(const SteadyState& state, Ellipsoids& axes, Analysis& analysis) {
  if (const std::string rest = state.at_rest(); !rest.empty()) return analysis.refuse(Group::motion, rest);
  analysis.estimate("tumbling_period") = statistics::tumbling_period({axes.x, axes.y, axes.z}, state.interval);
  const Index intervals = state.times - 1;
  const auto wanted = static_cast<Index>(std::lround(motion_window / state.interval));
  const Index length = std::min(wanted, intervals);
  if (length >= 2) keep_whole_windows(state, length, axes);
  const auto shares = statistics::motion_shares({axes.x, axes.y, axes.z}, state.interval, static_cast<double>(length) * state.interval);
  for (const auto& [name, share] : {std::pair{"tumbling_share", &shares.tumbling}, {"steady_share", &shares.steady}, {"rolling_share", &shares.rolling},
                                    {"half_turns", &shares.half_turns}}) {
    auto& estimate = analysis.estimate(name);
    estimate = *share;
    if (length < wanted) {
      doubt(estimate, fmt::format("the steady part, {:.3g} strains, is shorter than the {:g} strains in which a tumbling cell makes half a turn",
                                  static_cast<double>(intervals) * state.interval, motion_window));
    }
  }
}

}  // namespace

void add_shapes(const SteadyState& state, Analysis& analysis) {
  const std::string missing = state.without_bulk();
  if (!missing.empty()) {
    analysis.refuse(Group::motion, missing);
    return analysis.refuse(Group::shape, missing);
  }
  Ellipsoids cells = ellipsoids_of(state);
  MatrixXd deformation = cells.deformation.cwiseProduct(state.inside);
  const auto mean = SteadyState::mean_of_cells(deformation);
  analysis.estimate("deformation") = statistics::mean_estimate(mean, state.interval);
  analysis.curve("profile_deformation") = profile_curve(state, statistics::profile(state.heights, cells.deformation, layers_of(state, mean)), 1, mean);

  // Angles and axes turn with their cosines: the slower of the two tells how long a block has to be.
  cells.inclination = cells.inclination.cwiseProduct(state.inside);
  const auto cosine = SteadyState::mean_of_cells((2 * cells.inclination.array()).cos().matrix());
  auto& inclination = analysis.estimate("inclination");
  inclination = statistics::axial_mean(cells.inclination, state.blocks(cosine)).angle;
  state.judge(inclination, SteadyState::mean_of_cells((2 * cells.inclination.array()).sin().matrix()));

  for (MatrixXd* axis : {&cells.x, &cells.y, &cells.z}) *axis = axis->cwiseProduct(state.inside);
  const auto upright = SteadyState::mean_of_cells(cells.y.cwiseAbs2());
  const auto orientation = statistics::orientation({cells.x, cells.y, cells.z}, state.blocks(upright));
  auto& order = analysis.estimate("order_parameter");
  order = orientation.order;
  state.judge(order, upright);
  NamedTensor& tensor = analysis.tensor("orientation");
  tensor.value = orientation.tensor;
  tensor.error = orientation.tensor_error;
  tensor.converged = order.converged;
  tensor.reason = order.reason;
  add_motion(state, cells, analysis);
}

}  // namespace corpuscle::analysis
