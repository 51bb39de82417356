// Displacements of the cells along y and z.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "physics/analysis/groups.hpp"
#include "physics/statistics/diffusion.hpp"

namespace corpuscle::analysis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using statistics::BlockedCurve;
using statistics::Estimate;

constexpr double early_until = 0.3;           // strain
constexpr double displacement_window = 0.1;   // strain

// Slope of ln y against ln x between two lags.
Estimate exponent_between(const BlockedCurve& msd, double from, double to) {
  const double slack = 1 + 1e-9;
  Index points = 0;
  for (Index i = 0; i < msd.points(); ++i) points += msd.x[i] > 0 && msd.x[i] >= from / slack && msd.x[i] <= to * slack ? 1 : 0;
  if (!msd.reason.empty()) return {.reason = msd.reason};
  if (points < 3) return {.reason = fmt::format("{} lags between {:.3g} and {:.3g} strains are too few for an exponent (at least 3; output.series_every)", points, from, to)};
  return statistics::estimate_from(msd, [&](const VectorXd& y) {
    const statistics::FitData window{.x = msd.x, .y = (msd.x.array() >= from / slack && msd.x.array() <= to * slack).select(y, statistics::not_a_number), .error = {}};
    return statistics::fit_power_law(window).parameters[1];
  });
}

// The straight line whose slope is twice the diffusion coefficient, over the window that `diffusion_from_msd` takes.
void add_line(const BlockedCurve& msd, NamedFit& named) {
  if (!msd.reason.empty()) {
    named.fit.reason = msd.reason;
    return;
  }
  named.to = std::min(msd.trusted_until(), msd.x[msd.points() - 1]);
  named.from = named.to / 2;
  const double from = named.from * (1 - 1e-9), to = named.to * (1 + 1e-9);
  named.fit = statistics::fit_resampled(msd, [&](const statistics::FitData& data) {
    statistics::FitData window = data;
    window.y = (data.x.array() >= from && data.x.array() <= to).select(data.y, statistics::not_a_number);
    return statistics::fit_line(window);
  });
}

// Displacements over a window that starts in the bulk, [times - window][cells], and those of all cells.
BlockedCurve displacement_correlation(const SteadyState& state, const MatrixXd& positions) {
  const Index window = std::max<Index>(std::lround(displacement_window / state.interval), 1), rows = state.times - window;
  if (rows < 4) {
    BlockedCurve nothing;
    nothing.reason = fmt::format("{} samples are too few for displacements over {} intervals", state.times, window);
    return nothing;
  }
  const MatrixXd displacements = positions.bottomRows(rows) - positions.topRows(rows), from_bulk = displacements.cwiseProduct(state.inside.topRows(rows));
  return statistics::cross_correlation(from_bulk, displacements, state.interval, state.lags());
}

}  // namespace

void add_diffusion(const SteadyState& state, Analysis& analysis) {
  std::string missing = state.at_rest();
  if (missing.empty()) missing = state.without_company();
  if (!missing.empty()) return analysis.refuse(Group::diffusion, missing);
  for (int axis = 1; axis < 3; ++axis) {
    const std::string name(1, "xyz"[axis]);
    const MatrixXd positions = (axis == 2 ? state.heights : state.component(CellQuantity::centre, axis)) / state.record.radius;
    const BlockedCurve msd = statistics::mean_square_displacement(positions, state.inside, state.interval, state.lags());
    const BlockedCurve few = statistics::thinned(msd);
    analysis.curve("msd_" + name) = statistics::with_errors(few);
    analysis.curve("msd_exponent_" + name) = statistics::local_exponent(few);
    analysis.estimate("diffusivity_msd_" + name) = statistics::diffusion_from_msd(msd);
    add_line(msd, analysis.fit("msd_" + name + "_line"));

    Estimate &early = analysis.estimate("msd_exponent_" + name + "_early"), &late = analysis.estimate("msd_exponent_" + name + "_late");
    early = exponent_between(few, 0, early_until);
    const double last = few.points() > 0 ? std::min(few.trusted_until(), few.x[few.points() - 1]) : 0;
    late = exponent_between(few, last / 10, last);
    if (last / 10 < early_until) {
      doubt(late, fmt::format("trusted lags end at {:.3g} strains: a factor of ten below lies within the early {:g} strains", last, early_until));
    }
    analysis.curve("displacement_acf_" + name) = statistics::normalised(statistics::thinned(displacement_correlation(state, positions)));
  }
}

}  // namespace corpuscle::analysis
