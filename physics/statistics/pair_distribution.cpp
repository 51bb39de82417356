#include "physics/statistics/pair_distribution.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace corpuscle::statistics {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr Index most_blocks = 32;

struct Centre {
  std::array<double, 3> x;
  bool counted = false;  // has a g(r) of its own
};

}  // namespace

PairDistribution::PairDistribution(const PairOptions& options) : options_(options) {
  double largest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(options.size[i] > 0)) refusal_ = fmt::format("a box of {:g} x {:g} x {:g} has no volume", options.size[0], options.size[1], options.size[2]);
    if (options.periodic[i]) largest = std::min(largest, options.size[i] / 2);
  }
  if (refusal_.empty() && !(options.reach > 0 && options.reach <= largest)) {
    refusal_ = fmt::format("pairs up to a distance of {:g} cannot be counted: more than 0 and at most half of each periodic size, {:g}", options.reach, largest);
  }
  if (refusal_.empty() && (options.bins < 1 || options.contact_distance > options.reach)) {
    refusal_ = "g(r) needs a bin and a reach beyond the contact distance";
  }
  if (refusal_.empty() && !options.periodic[2] && 2 * options.wall_layer >= options.size[2]) {
    refusal_ = fmt::format("no bulk region is left between two layers of {:g} in a gap of {:g}", options.wall_layer, options.size[2]);
  }
  if (refusal_.empty() && !(options.periodic[0] && options.periodic[1])) refusal_ = "walls are possible in the z direction only";
  const Index bins = std::max<Index>(options.bins, 1);
  pairs_ = expected_ = MatrixXd::Zero(bins, most_blocks);
  contacts_ = centres_ = MatrixXd::Zero(1, most_blocks);
}

// Of a ball, between walls `z_down` below its centre and `z_up` above: integral of pi (R^2 - z^2).
double PairDistribution::volume_within(double radius, double z_down, double z_up) const {
  const auto part = [radius](double height) {
    const double h = std::clamp(height, 0.0, radius);
    return std::numbers::pi * (radius * radius * h - h * h * h / 3);
  };
  return part(z_down) + part(z_up);
}

void PairDistribution::join_blocks() {
  for (MatrixXd* sums : {&pairs_, &expected_, &contacts_, &centres_}) {
    for (Index b = 0; b < most_blocks / 2; ++b) sums->col(b) = (sums->col(2 * b) + sums->col(2 * b + 1)).eval();
    sums->rightCols(most_blocks / 2).setZero();
  }
  per_block_ *= 2;
}

void PairDistribution::add(std::span<const double> positions) {
  if (!refusal_.empty()) return;
  if (snapshots_ == per_block_ * most_blocks) join_blocks();
  const Index block = snapshots_++ / per_block_;

  const bool walls = !options_.periodic[2];
  const double low = options_.origin[2], height = options_.size[2], reach = options_.reach;
  std::vector<Centre> centres;
  for (std::size_t i = 0; i + 2 < positions.size(); i += 3) {
    Centre centre{{positions[i], positions[i + 1], positions[i + 2]}, true};
    if (std::isnan(centre.x[0] + centre.x[1] + centre.x[2])) continue;
    const double z = centre.x[2] - low;
    if (walls) {
      centre.counted = z >= options_.wall_layer && z <= height - options_.wall_layer;
    } else {
      centre.x[2] -= height * std::floor(z / height);
    }
    centres.push_back(centre);
  }
  std::sort(centres.begin(), centres.end(), [](const Centre& a, const Centre& b) { return a.x[2] < b.x[2]; });
  const auto counted = static_cast<double>(std::count_if(centres.begin(), centres.end(), [](const Centre& c) { return c.counted; }));
  centres_(0, block) += counted;
  if (counted < 1) return;
  const double region = walls ? height - 2 * options_.wall_layer : height;
  const double density = (counted - 1) / (options_.size[0] * options_.size[1] * region);

  const Index bins = pairs_.rows();
  const double scale = static_cast<double>(bins) / reach;
  const auto visit = [&](const Centre& a, const Centre& b, double dz) {
    double square = dz * dz;
    for (std::size_t k = 0; k < 2; ++k) {
      double d = a.x[k] - b.x[k];
      d -= options_.size[k] * std::round(d / options_.size[k]);
      square += d * d;
    }
    if (square >= reach * reach) return;
    const double ends = (a.counted ? 1 : 0) + (b.counted ? 1 : 0), distance = std::sqrt(square);
    pairs_(std::min(static_cast<Index>(distance * scale), bins - 1), block) += ends;
    if (distance < options_.contact_distance) contacts_(0, block) += ends;
  };
  // Sorted by z: the partners of a centre follow it, and with a periodic z also come from the bottom, one height up.
  for (std::size_t i = 0; i < centres.size(); ++i) {
    std::size_t j = i + 1;
    for (; j < centres.size() && centres[j].x[2] - centres[i].x[2] < reach; ++j) visit(centres[i], centres[j], centres[j].x[2] - centres[i].x[2]);
    if (walls || j < centres.size()) continue;
    for (std::size_t k = 0; k < i && centres[k].x[2] + height - centres[i].x[2] < reach; ++k) {
      // Half the height away both ways: the pair was met already.
      if (centres[i].x[2] - centres[k].x[2] < reach) continue;
      visit(centres[i], centres[k], centres[k].x[2] + height - centres[i].x[2]);
    }
  }
  for (const Centre& centre : centres) {
    if (!centre.counted) continue;
    const double down = walls ? std::max(centre.x[2] - low, 0.0) : reach, up = walls ? std::max(low + height - centre.x[2], 0.0) : reach;
    double inner = 0;
    for (Index bin = 0; bin < bins; ++bin) {
      const double outer = volume_within(static_cast<double>(bin + 1) / scale, down, up);
      expected_(bin, block) += density * (outer - inner);
      inner = outer;
    }
  }
}

BlockedCurve PairDistribution::result() const {
  BlockedCurve curve;
  curve.reason = refusal_;
  if (curve.reason.empty() && snapshots_ == 0) curve.reason = "there is no snapshot";
  if (curve.reason.empty() && expected_.sum() <= 0) curve.reason = "fewer than two cells lie in the region: there are no pairs";
  if (!curve.reason.empty()) return curve;
  const Index bins = pairs_.rows(), blocks = (snapshots_ + per_block_ - 1) / per_block_;
  const double half = 0.5 * options_.reach / static_cast<double>(bins);
  curve.x = Eigen::VectorXd::LinSpaced(bins, half, options_.reach - half);
  curve.sums = pairs_.leftCols(blocks);
  curve.counts = expected_.leftCols(blocks);
  return curve;
}

Estimate PairDistribution::contact_number(const Resampling& resampling) const {
  BlockedCurve curve;
  curve.reason = refusal_;
  if (curve.reason.empty() && !(options_.contact_distance > 0)) curve.reason = "no contact distance was given";
  if (curve.reason.empty() && centres_.sum() <= 0) curve.reason = "there is no cell in the region";
  const Index blocks = (snapshots_ + per_block_ - 1) / per_block_;
  curve.sums = contacts_.leftCols(blocks);
  curve.counts = centres_.leftCols(blocks);
  return estimate_from(curve, [](const Eigen::VectorXd& y) { return y[0]; }, resampling);
}

}  // namespace corpuscle::statistics
