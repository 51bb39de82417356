#include "physics/statistics/multiple_tau_correlator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace corpuscle::statistics {

MultipleTauCorrelator::MultipleTauCorrelator(Quantity quantity, std::size_t particles, double time_step, const MultipleTauOptions& options)
    : quantity_(quantity), particles_(particles), time_step_(time_step), options_(options) {
  options_.channels = std::max(2, options.channels / 2 * 2);
  options_.levels = std::max(1, options.levels);
  options_.blocks = std::max<Eigen::Index>(2, options.blocks / 2 * 2);
  if (quantity == Quantity::mean_square_displacement) options_.average = false;  // the mean of two positions is no position
}

void MultipleTauCorrelator::add(std::span<const double> values) {
  if (samples_ == stretch_ * 2 * options_.blocks) join_stretches();
  add_to(0, values.first(std::min(values.size(), particles_)));
  ++samples_;
}

void MultipleTauCorrelator::add_to(std::size_t level, std::span<const double> values) {
  const auto channels = static_cast<std::size_t>(options_.channels);
  if (level == levels_.size()) {
    Level fresh;
    fresh.history.assign(channels * particles_, not_a_number);
    if (options_.average) fresh.pending.assign(particles_, not_a_number);
    fresh.sums = fresh.counts = Eigen::MatrixXd::Zero(options_.channels, 2 * options_.blocks);
    levels_.push_back(std::move(fresh));
  }
  Level& here = levels_[level];
  const auto slot = static_cast<std::size_t>(here.received) % channels;
  std::copy(values.begin(), values.end(), here.history.begin() + static_cast<std::ptrdiff_t>(slot * particles_));
  std::fill(here.history.begin() + static_cast<std::ptrdiff_t>(slot * particles_ + values.size()),
            here.history.begin() + static_cast<std::ptrdiff_t>((slot + 1) * particles_), not_a_number);
  const double* now = here.history.data() + slot * particles_;
  const auto column = static_cast<Eigen::Index>(samples_ / stretch_);
  const std::size_t first = level == 0 ? 0 : channels / 2;
  for (std::size_t lag = first; lag < channels && static_cast<std::int64_t>(lag) <= here.received; ++lag) {
    const double* before = here.history.data() + (slot + channels - lag) % channels * particles_;
    double sum = 0, count = 0;
    for (std::size_t p = 0; p < particles_; ++p) {
      const double difference = now[p] - before[p];
      const double term = quantity_ == Quantity::autocorrelation ? now[p] * before[p] : difference * difference;
      const bool valid = !std::isnan(term);
      sum += valid ? term : 0;
      count += valid ? 1 : 0;
    }
    here.sums(static_cast<Eigen::Index>(lag), column) += sum;
    here.counts(static_cast<Eigen::Index>(lag), column) += count;
  }
  const std::int64_t number = here.received++;
  if (level + 1 >= static_cast<std::size_t>(options_.levels)) return;
  if (!options_.average) {
    if (number % 2 == 0) add_to(level + 1, {now, particles_});
    return;
  }
  if (number % 2 == 0) {
    std::copy(now, now + particles_, here.pending.begin());
  } else {
    std::vector<double> mean(particles_);
    for (std::size_t p = 0; p < particles_; ++p) mean[p] = 0.5 * (here.pending[p] + now[p]);
    add_to(level + 1, mean);
  }
}

void MultipleTauCorrelator::join_stretches() {
  for (Level& level : levels_) {
    for (Eigen::MatrixXd* sums : {&level.sums, &level.counts}) {
      for (Eigen::Index b = 0; b < options_.blocks; ++b) sums->col(b) = (sums->col(2 * b) + sums->col(2 * b + 1)).eval();
      sums->rightCols(options_.blocks).setZero();
    }
  }
  stretch_ *= 2;
}

BlockedCurve MultipleTauCorrelator::result() const {
  BlockedCurve curve;
  if (samples_ < 2 || particles_ == 0) {
    curve.reason = particles_ == 0 ? "there is no particle" : fmt::format("{} samples in time are too few for a correlation", samples_);
    return curve;
  }
  const Eigen::Index stretches = (samples_ + stretch_ - 1) / stretch_;
  curve.block_length = static_cast<double>(stretch_) * time_step_;
  std::vector<double> lags;
  std::vector<Eigen::VectorXd> sums, counts;
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    for (Eigen::Index lag = k == 0 ? 0 : options_.channels / 2; lag < options_.channels; ++lag) {
      if (levels_[k].counts.row(lag).sum() <= 0) continue;
      lags.push_back(static_cast<double>(lag) * std::ldexp(time_step_, static_cast<int>(k)));
      sums.emplace_back(levels_[k].sums.row(lag).head(stretches));
      counts.emplace_back(levels_[k].counts.row(lag).head(stretches));
    }
  }
  const auto points = static_cast<Eigen::Index>(lags.size());
  curve.x = Eigen::Map<const Eigen::VectorXd>(lags.data(), points);
  curve.sums.resize(points, stretches);
  curve.counts.resize(points, stretches);
  for (Eigen::Index i = 0; i < points; ++i) {
    curve.sums.row(i) = sums[static_cast<std::size_t>(i)];
    curve.counts.row(i) = counts[static_cast<std::size_t>(i)];
  }
  if (points == 0) curve.reason = "there is no valid sample";
  return curve;
}

// samples, stretch, then per level: received, history, pending, sums, counts.
std::vector<double> MultipleTauCorrelator::save() const {
  std::vector<double> saved{static_cast<double>(samples_), static_cast<double>(stretch_)};
  const auto append = [&](const double* values, std::size_t size) { saved.insert(saved.end(), values, values + size); };
  for (const Level& level : levels_) {
    saved.push_back(static_cast<double>(level.received));
    append(level.history.data(), level.history.size());
    append(level.pending.data(), level.pending.size());
    for (const Eigen::MatrixXd* sums : {&level.sums, &level.counts}) append(sums->data(), static_cast<std::size_t>(sums->size()));
  }
  return saved;
}

bool MultipleTauCorrelator::restore(std::span<const double> saved) {
  const auto is_count = [](double value) { return value >= 0 && value < 9e15 && value == std::floor(value); };
  const std::size_t history = static_cast<std::size_t>(options_.channels) * particles_, pending = options_.average ? particles_ : 0;
  const auto sums = static_cast<std::size_t>(options_.channels * 2 * options_.blocks), width = 1 + history + pending + 2 * sums;
  if (saved.size() < 2 || (saved.size() - 2) % width != 0 || !is_count(saved[0]) || !is_count(saved[1]) || saved[1] < 1) return false;
  const std::size_t count = (saved.size() - 2) / width;
  if (count > static_cast<std::size_t>(options_.levels) || saved[0] > saved[1] * 2 * static_cast<double>(options_.blocks)) return false;
  std::vector<Level> levels(count);
  auto from = saved.begin() + 2;
  for (Level& level : levels) {
    if (!is_count(*from)) return false;
    level.received = static_cast<std::int64_t>(*from++);
    const auto take = [&](std::size_t size) { return std::vector<double>(from, from + static_cast<std::ptrdiff_t>(size)); };
    level.history = take(history);
    from += static_cast<std::ptrdiff_t>(history);
    level.pending = take(pending);
    from += static_cast<std::ptrdiff_t>(pending);
    for (Eigen::MatrixXd* matrix : {&level.sums, &level.counts}) {
      *matrix = Eigen::Map<const Eigen::MatrixXd>(&*from, options_.channels, 2 * options_.blocks);
      from += static_cast<std::ptrdiff_t>(sums);
    }
  }
  samples_ = static_cast<std::int64_t>(saved[0]);
  stretch_ = static_cast<std::int64_t>(saved[1]);
  levels_ = std::move(levels);
  return true;
}

std::size_t MultipleTauCorrelator::bytes() const {
  std::size_t doubles = 0;
  for (const Level& level : levels_) {
    doubles += level.history.size() + level.pending.size() + static_cast<std::size_t>(level.sums.size() + level.counts.size());
  }
  return doubles * sizeof(double);
}

}  // namespace corpuscle::statistics
