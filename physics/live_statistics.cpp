#include "physics/live_statistics.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "physics/statistics/correlation.hpp"
#include "physics/statistics/diffusion.hpp"
#include "physics/suspension_sample.hpp"

namespace corpuscle {
namespace {

using statistics::BlockedCurve;
using statistics::MultipleTauCorrelator;
constexpr std::array names{"x", "y", "z"};

/// A saved run of numbers, taken from the front.
std::span<const double> take(std::span<const double>& from, std::size_t size) {
  if (from.size() < size) throw OutputError("The checkpoint's statistics don't have the form that this version reads");
  const auto taken = from.first(size);
  from = from.subspan(size);
  return taken;
}

}  // namespace

LiveStatistics::LiveStatistics(const LatticeParameters& lattice, bool walls, double discard)
    : cells_(0), every_(lattice.series_every), shear_rate_(lattice.shear_rate), radius_(lattice.radius), height_(lattice.nodes[2]),
      layer_(corpuscle::wall_layer(lattice, walls)) {
  for (const auto& type : lattice.cells) cells_ += static_cast<std::size_t>(type.count);
  const auto discarded = static_cast<std::int64_t>(std::ceil(discard * static_cast<double>(lattice.steps)));
  first_step_ = (discarded + every_ - 1) / every_ * every_;
  const double interval = shear_rate_ * static_cast<double>(every_);
  using Quantity = MultipleTauCorrelator::Quantity;
  for (int k = 0; k < 3; ++k) velocities_.emplace_back(Quantity::autocorrelation, cells_, interval);
  for (int k = 1; k < 3; ++k) positions_.emplace_back(Quantity::mean_square_displacement, cells_, interval);
  for (auto& counts : counts_) counts = Eigen::MatrixXd::Zero(bins, stretches);
  valid_ = Eigen::MatrixXd::Zero(3, stretches);
}

void LiveStatistics::add(const Sample& sample) {
  if (sample.step < first_step_ || sample.step % every_ != 0) return;
  if (samples_ == 0) from_strain_ = sample.strain;
  to_strain_ = sample.strain;
  if (samples_ == per_stretch_ * stretches) {
    const auto join = [](Eigen::MatrixXd& m) {
      for (int b = 0; b < stretches / 2; ++b) m.col(b) = (m.col(2 * b) + m.col(2 * b + 1)).eval();
      m.rightCols(stretches / 2).setZero();
    };
    for (auto& counts : counts_) join(counts);
    join(valid_);
    per_stretch_ *= 2;
  }
  std::vector<double> value(cells_);
  const double unit = shear_rate_ * radius_;
  for (int k = 0; k < 3; ++k) {
    const auto in_bulk = [&](const CellSample& cell, double x) {
      return layer_ == 0 || (cell.centre[2] >= layer_ && cell.centre[2] <= height_ - layer_) ? x : statistics::not_a_number;
    };
    for (std::size_t c = 0; c < cells_; ++c) {
      const CellSample& cell = sample.cells[c];
      const double mean_flow = k == 0 ? shear_rate_ * (cell.centre[2] - height_ / 2) : 0;
      value[c] = in_bulk(cell, (cell.velocity[k] - mean_flow) / unit);
    }
    velocities_[k].add(value);
    count(k, value);
    if (k == 0) continue;
    for (std::size_t c = 0; c < cells_; ++c) value[c] = in_bulk(sample.cells[c], sample.cells[c].centre[k] / radius_);
    positions_[k - 1].add(value);
  }
  ++samples_;
}

void LiveStatistics::count(int component, std::span<const double> fluctuation) {
  const std::int64_t stretch = samples_ / per_stretch_;
  for (const double value : fluctuation) {
    if (std::isnan(value)) continue;
    valid_(component, stretch) += 1;
    const double bin = std::floor((value + reach) / (2 * reach) * bins);
    if (bin >= 0 && bin < bins) counts_[component](static_cast<Eigen::Index>(bin), stretch) += 1;
  }
}

statistics::Histogram LiveStatistics::histogram(int component) const {
  statistics::Histogram h;
  h.edges = Eigen::VectorXd::LinSpaced(bins + 1, -reach, reach);
  const std::int64_t used = (samples_ + per_stretch_ - 1) / per_stretch_;
  h.counts = counts_[component].leftCols(used);
  h.samples = valid_.row(component).head(used).transpose();
  if (samples_ == 0) h.reason = "there is no sample after the start that is left out (run.discard)";
  return h;
}

LiveResults LiveStatistics::result() const {
  LiveResults results;
  results.samples = samples_;
  results.from_strain = from_strain_;
  results.to_strain = to_strain_;
  for (int k = 0; k < 3; ++k) {
    const std::string name = names[k];
    const BlockedCurve vacf = velocities_[k].result();
    results.estimates.emplace_back("velocity_variance_" + name, statistics::estimate_from(vacf, [](const Eigen::VectorXd& c) { return c.size() > 0 ? c[0] : statistics::not_a_number; }));
    results.estimates.emplace_back("relaxation_time_" + name, statistics::relaxation_time(vacf));
    results.curves.emplace_back("vacf_" + name, statistics::normalised(vacf));
    results.curves.emplace_back("pdf_velocity_" + name, statistics::probability_density(histogram(k)));
    if (k == 0) continue;
    const BlockedCurve msd = positions_[k - 1].result();
    results.estimates.emplace_back("diffusivity_vacf_" + name, statistics::diffusion_from_vacf(vacf));
    results.estimates.emplace_back("diffusivity_msd_" + name, statistics::diffusion_from_msd(msd));
    const auto stretched = statistics::diffusion_from_stretched_exponential(vacf, 1);
    results.estimates.emplace_back("diffusivity_gamma_" + name, stretched.diffusion);
    results.fits.emplace_back("vacf_" + name + "_stretched_exponential", stretched.fit);
    results.curves.emplace_back("msd_" + name, statistics::with_errors(msd));
    results.curves.emplace_back("msd_exponent_" + name, statistics::local_exponent(msd));
  }
  return results;
}

// first step, samples, per stretch, strains, histograms, then each correlator behind its length.
std::vector<double> LiveStatistics::save() const {
  std::vector<double> saved{static_cast<double>(first_step_), static_cast<double>(samples_), static_cast<double>(per_stretch_), from_strain_, to_strain_};
  const auto append = [&](const Eigen::MatrixXd& m) { saved.insert(saved.end(), m.data(), m.data() + m.size()); };
  for (const auto& counts : counts_) append(counts);
  append(valid_);
  for (const auto* group : {&velocities_, &positions_})
    for (const auto& correlator : *group) {
      const auto numbers = correlator.save();
      saved.push_back(static_cast<double>(numbers.size()));
      saved.insert(saved.end(), numbers.begin(), numbers.end());
    }
  return saved;
}

void LiveStatistics::restore(std::span<const double> saved) {
  const auto head = take(saved, 5);
  const auto is_count = [](double value) { return value >= 0 && value < 9e15 && value == std::floor(value); };
  const auto require = [](bool holds) {
    if (!holds) throw OutputError("The checkpoint's statistics contradict themselves");
  };
  require(is_count(head[0]) && is_count(head[1]) && is_count(head[2]) && head[2] >= 1 && head[1] <= stretches * head[2]);
  first_step_ = static_cast<std::int64_t>(head[0]);
  samples_ = static_cast<std::int64_t>(head[1]);
  per_stretch_ = static_cast<std::int64_t>(head[2]);
  from_strain_ = head[3];
  to_strain_ = head[4];
  const auto read = [&](Eigen::MatrixXd& m) { m = Eigen::Map<const Eigen::MatrixXd>(take(saved, static_cast<std::size_t>(m.size())).data(), m.rows(), m.cols()); };
  for (auto& counts : counts_) read(counts);
  read(valid_);
  for (auto* group : {&velocities_, &positions_})
    for (auto& correlator : *group) {
      const double size = take(saved, 1)[0];
      require(is_count(size));
      require(correlator.restore(take(saved, static_cast<std::size_t>(size))));
    }
}

std::size_t LiveStatistics::predicted_bytes(std::size_t cells) {
  const statistics::MultipleTauOptions options;
  const auto channels = static_cast<std::size_t>(options.channels), correlators = std::size_t{5};
  const std::size_t level = channels * cells + 2 * channels * 2 * static_cast<std::size_t>(options.blocks);
  return sizeof(double) * (correlators * static_cast<std::size_t>(options.levels) * level + std::size_t{3} * (bins + 1) * stretches);
}

std::size_t LiveStatistics::bytes() const {
  std::size_t sum = sizeof(double) * static_cast<std::size_t>(3 * bins * stretches + valid_.size());
  for (const auto* group : {&velocities_, &positions_})
    for (const auto& correlator : *group) sum += correlator.bytes();
  return sum;
}

}  // namespace corpuscle
