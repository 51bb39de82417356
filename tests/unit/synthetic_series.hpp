// Random series whose statistics are known exactly, and what the tests of the statistics ask of estimates from them.
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/random.hpp"
#include "tests/catch.hpp"

namespace corpuscle::test {

/// Standard normal draws (Box & Muller) from a counter-based stream, the same on every machine.
class Normal {
 public:
  explicit Normal(std::uint64_t seed) : random_(seed) {}
  double operator()() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double radius = std::sqrt(-2 * std::log1p(-random_.uniform())), angle = 2 * std::numbers::pi * random_.uniform();
    spare_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
  }
  double uniform() { return random_.uniform(); }

 private:
  RandomStream random_;
  double spare_ = 0;
  bool has_spare_ = false;
};

/// Stationary AR(1) series x_i = a x_{i-1} + noise of variance 1: C(t) = a^t, tau = 1/2 + a/(1-a). Sampled Ornstein-Uhlenbeck process: a = exp(-dt/T).
inline std::vector<double> ar1(double a, double mean, std::size_t n, Normal& normal) {
  std::vector<double> series(n);
  double x = normal();
  const double kick = std::sqrt(1 - a * a);
  for (auto& value : series) {
    value = mean + x;
    x = a * x + kick * normal();
  }
  return series;
}

/// Independent AR(1) series in columns.
inline Eigen::MatrixXd ar1_matrix(double a, Eigen::Index times, Eigen::Index particles, Normal& normal) {
  Eigen::MatrixXd result(times, particles);
  for (Eigen::Index p = 0; p < particles; ++p) {
    const auto series = ar1(a, 0, static_cast<std::size_t>(times), normal);
    result.col(p) = Eigen::Map<const Eigen::VectorXd>(series.data(), times);
  }
  return result;
}

/// Share of hits with its binomial error.
struct Coverage {
  int hits = 0, tries = 0;
  void add(double value, double error, double truth) {
    hits += std::abs(value - truth) < error ? 1 : 0;
    ++tries;
  }
  double share() const { return static_cast<double>(hits) / tries; }
  double error() const { return std::sqrt(share() * (1 - share()) / tries); }
};

/// Error bars of one standard deviation: 68 % of normal errors lie within, 60 to 75 % are accepted.
inline void check(const Coverage& coverage) {
  CAPTURE(coverage.share(), coverage.error());
  CHECK(coverage.share() > 0.60);
  CHECK(coverage.share() < 0.75);
}

/// Whether the reason of an estimate contains these words.
inline bool says(const std::string& reason, const std::string& words) { return reason.find(words) != std::string::npos; }

}  // namespace corpuscle::test
