// Statistics of a running simulation against processes whose answers are known.
#include "physics/live_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.hpp"
#include "tests/catch.hpp"
#include "tests/unit/synthetic_series.hpp"

using namespace corpuscle;
using namespace corpuscle::test;

namespace {

constexpr int cells = 40;
constexpr double shear_rate = 1e-3, radius = 5, height = 100, interval = 0.05;  // of samples, in strain

LatticeParameters some_lattice() {
  LatticeParameters lattice;
  lattice.radius = radius;
  lattice.shear_rate = shear_rate;
  lattice.nodes = {50, 50, int(height)};
  lattice.series_every = 50;
  lattice.steps = 50 * 4000;
  lattice.cells.resize(1);
  lattice.cells[0].count = cells;
  return lattice;
}

/// Cells whose velocity fluctuations are Ornstein-Uhlenbeck processes: C(t) = sigma^2 exp(-t/tau), D = sigma^2 tau, in shear rate and r. Every second one stays near a wall, and is
/// much faster there.
class Walkers {
 public:
  static constexpr double sigma = 0.3, tau = 0.5;
  Sample next() {
    Sample sample;
    sample.step = step_;
    sample.strain = shear_rate * double(step_);
    sample.cells.resize(cells);
    const double a = std::exp(-interval / tau), kick = sigma * std::sqrt(1 - a * a);
    for (int c = 0; c < cells; ++c) {
      auto& cell = sample.cells[c];
      for (int k = 0; k < 3; ++k) {
        u_[c][k] = step_ == 0 ? sigma * normal_() : a * u_[c][k] + kick * normal_();
        if (k < 2) x_[c][k] += u_[c][k] * interval;
        cell.centre[k] = radius * x_[c][k];
        cell.velocity[k] = shear_rate * radius * u_[c][k];
      }
      const bool bulk = c % 2 == 0;
      cell.centre[2] = bulk ? 30 + c : 10;
      if (!bulk)
        for (double& u : cell.velocity) u *= 10;
      cell.velocity[0] += shear_rate * (cell.centre[2] - height / 2);
    }
    step_ += 50;
    return sample;
  }

 private:
  Normal normal_{11};
  std::int64_t step_ = 0;
  std::array<std::array<double, 3>, cells> u_{}, x_{};
};

template <class Pairs>
auto by_name(const Pairs& pairs) {
  std::map<std::string, typename Pairs::value_type::second_type> found;
  for (const auto& [name, value] : pairs) found[name] = value;
  return found;
}

}  // namespace

TEST_CASE("Live statistics of Ornstein-Uhlenbeck walkers: variance, relaxation, diffusion, density, without the start and the layers at the walls", "[statistics]") {
  LiveStatistics live(some_lattice(), true, 0.25);
  Walkers walkers;
  for (int i = 0; i < 4000; ++i) {
    Sample sample = walkers.next();
    if (i < 900)  // a wild start
      for (auto& cell : sample.cells) cell.velocity[1] += 1;
    live.add(sample);
    if (i % 7 == 0) {  // the sample at the end of a run lies off the cadence
      sample.step += 1;
      live.add(sample);
    }
  }
  const LiveResults results = live.result();
  CHECK(results.samples == 3000);
  CHECK(results.from_strain == Approx(50));
  const auto estimates = by_name(results.estimates);
  const auto close = [&](const std::string& name, double expected, double systematic = 0) {
    const auto& e = estimates.at(name);
    INFO(name << " " << e.value << " +- " << e.error << ", expected " << expected << "; " << e.reason);
    CHECK(e.error > 0);
    CHECK(e.error < 0.1 * expected);
    CHECK(std::abs(e.value - expected) < 4 * e.error + systematic * expected);
  };
  const double variance = Walkers::sigma * Walkers::sigma, diffusivity = variance * Walkers::tau;
  const double trapezoidal = interval * interval / (12 * Walkers::tau * Walkers::tau);  // of the integral of an exponential; and 0.25 % are cut off
  for (const std::string k : {"x", "y", "z"}) {
    close("velocity_variance_" + k, variance);
    close("relaxation_time_" + k, Walkers::tau, trapezoidal + 0.0025);
  }
  close("diffusivity_vacf_y", diffusivity, trapezoidal + 0.0025);
  close("diffusivity_gamma_y", diffusivity);
  close("diffusivity_msd_y", diffusivity, trapezoidal);  // positions are sums of velocities times the interval: the same rule
  const auto curves = by_name(results.curves);
  const auto& density = curves.at("pdf_velocity_y");
  const Eigen::Index middle = density.x.size() / 2;
  CHECK(density.value[middle] == Approx(1 / (Walkers::sigma * std::sqrt(2 * M_PI))).epsilon(0.02));
  CHECK(by_name(results.fits).at("vacf_z_stretched_exponential").parameter("exponent").value == Approx(1).margin(0.05));
}

TEST_CASE("Live statistics that were saved go on bit for bit; what they are not is refused", "[statistics]") {
  LiveStatistics whole(some_lattice(), true, 0.1), first(some_lattice(), true, 0.1), second(some_lattice(), true, 0.5);
  Walkers walkers;
  std::size_t bytes = 0;
  for (int i = 0; i < 3900; ++i) {
    const Sample sample = walkers.next();
    whole.add(sample);
    if (i < 1234) first.add(sample);
    if (i == 1234) second.restore(first.save());
    if (i >= 1234) second.add(sample);
    if (i == 2500) bytes = whole.bytes();
  }
  CHECK(whole.bytes() == bytes);
  CHECK(whole.bytes() == LiveStatistics::predicted_bytes(cells));
  const auto same = [](const std::vector<double>& a, const std::vector<double>& b) {
    return std::ranges::equal(a, b, [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
  };
  CHECK(same(whole.save(), second.save()));
  auto saved = whole.save();
  saved.pop_back();
  CHECK_THROWS_AS(second.restore(saved), OutputError);
  saved[1] = -1;
  CHECK_THROWS_AS(second.restore(saved), OutputError);
  LiveStatistics young(some_lattice(), true, 0.5);
  const auto results = young.result();
  CHECK(results.samples == 0);
  for (const auto& [name, e] : results.estimates) {
    INFO(name);
    CHECK(std::isnan(e.value));
    CHECK(!e.converged);
    CHECK(!e.reason.empty());
  }
}
