// Analysis: fluctuations of Ornstein-Uhlenbeck cells in a shear flow.
#include <map>
#include <numbers>
#include <string>

#include "physics/analysis/analyse.hpp"
#include "physics/statistics/dissipation.hpp"
#include "tests/catch.hpp"
#include "tests/unit/synthetic_run.hpp"

using namespace corpuscle;
using namespace corpuscle::test;
using Eigen::Index;

namespace {

constexpr analysis::AnalysisOptions from_start{.wall_layer = 2, .discard = 0};

}  // namespace

TEST_CASE("analysis: variances, relaxation and diffusion of Ornstein-Uhlenbeck cells", "[analysis]") {
  SyntheticRun run{.times = 6000, .cells = 30};
  const auto found = analysis::analyse(run.record(), from_start);
  const char* names[3] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name = names[axis];
    CAPTURE(name);
    const auto& variance = found.estimate("velocity_variance_" + name);
    agrees(variance, run.deviation[axis] * run.deviation[axis]);
    CHECK(variance.converged);
    CHECK(variance.error < 0.05 * variance.value);
    // The mean of 30 cells' squares decays as the square of the correlation.
    CHECK(variance.correlation_time == Approx(0.1 / 2 / std::tanh(0.2)).epsilon(0.3));
    agrees(found.estimate("velocity_kurtosis_" + name), 0);
    agrees(found.estimate("relaxation_time_" + name), run.relaxation_time() * (1 - std::exp(-6.0)));
    CHECK(found.estimate("relaxation_time_" + name).converged);
    const auto& vacf = found.curve("vacf_" + name);
    CHECK(vacf.value[0] == Approx(1));
    CHECK(std::abs(vacf.value[3] - std::exp(-0.6)) < 5 * vacf.error[3]);
    if (axis == 0) continue;
    agrees(found.estimate("diffusivity_vacf_" + name), run.diffusivity(axis) * (1 - std::exp(-6.0)));
    agrees(found.estimate("diffusivity_msd_" + name), run.diffusivity(axis));
    agrees(found.estimate("diffusivity_gamma_" + name), run.deviation[axis] * run.deviation[axis] * 0.5);  // tau = 0.5 strains
    const auto& fit = found.fit("vacf_" + name + "_stretched_exponential");
    agrees(fit.fit.parameter("amplitude"), 1);
    agrees(fit.fit.parameter("time"), 0.5);
    agrees(fit.fit.parameter("exponent"), 1);
    CHECK(fit.to == 1);
  }
  // Pairs are in the bulk at the beginning: there is no bias from cells that leave along z. MSD = 2 D (t - tau) to within the discrete sums.
  CHECK(found.estimate("diffusivity_msd_z").converged);
}

TEST_CASE("analysis: referred to the shear rate of the bulk", "[analysis]") {
  SyntheticRun run{.times = 3000, .cells = 40};
  const auto record = run.record();
  const auto walls = analysis::analyse(record, from_start);
  auto options = from_start;
  CHECK(analysis::analyse_referred(record, options).first.rate_factor == 1);
  options.rate = analysis::RateOf::bulk;
  const auto [referred, bulk] = analysis::analyse_referred(record, options);
  const double s = walls.estimate("shear_rate_bulk").value;
  CHECK(referred.rate_factor == Approx(s));
  CHECK(referred.capillary_number == Approx(s * record.capillary_number));
  CHECK(bulk.estimate("shear_rate_bulk").value == Approx(1).epsilon(1e-6));
  CHECK(bulk.estimate("relative_viscosity").value == Approx(walls.estimate("relative_viscosity_local_rate").value));
  CHECK(bulk.estimate("whole_relative_viscosity").value - 1 == Approx((walls.estimate("whole_relative_viscosity").value - 1) / s));
  CHECK(bulk.estimate("wall_relative_viscosity").value == Approx(walls.estimate("wall_relative_viscosity").value / s));
  // A rate: velocities over s, times times s, D in rate x r^2 over s.
  CHECK(bulk.estimate("velocity_variance_y").value == Approx(walls.estimate("velocity_variance_y").value / (s * s)));
  CHECK(bulk.estimate("relaxation_time_y").value == Approx(walls.estimate("relaxation_time_y").value * s));
  CHECK(bulk.estimate("diffusivity_vacf_y").value == Approx(walls.estimate("diffusivity_vacf_y").value / s));
  CHECK(bulk.estimate("stress_fluctuation").value == Approx(walls.estimate("stress_fluctuation").value));

  auto without = record;
  without.cells = nullptr;
  const auto unknown = analysis::analyse_referred(without, options);
  CHECK(unknown.first.rate_factor == 1);
  REQUIRE(!unknown.second.warnings.empty());
  CHECK(says(unknown.second.warnings.back(), "referred to the shear rate of the walls"));
}

TEST_CASE("analysis: mean flow, measured and uniform", "[analysis]") {
  SyntheticRun run{.times = 3000, .cells = 40};
  const auto record = run.record();
  const auto measured = analysis::analyse(record, from_start);
  agrees(measured.estimate("shear_rate_bulk"), 0.9);
  CHECK(measured.estimate("shear_rate_bulk").error < 0.02);
  const auto& profile = measured.curve("profile_velocity");
  REQUIRE(profile.x.size() == 24);
  for (Index i = 4; i < 20; ++i) {
    CAPTURE(profile.x[i]);
    // Cells are not at the middle of a layer on average: the shear rate that isn't taken off first shifts a mean by 0.1 x a fraction of the layer.
    CHECK(std::abs(profile.value[i] - 0.9 * (profile.x[i] - 6)) < 5 * profile.error[i] + 0.01);
  }
  const auto& viscosity = measured.estimate("relative_viscosity");
  CHECK(measured.estimate("relative_viscosity_local_rate").value == Approx(1 + (viscosity.value - 1) / measured.estimate("shear_rate_bulk").value));

  // About the imposed flow the difference of both flows counts as a fluctuation: (0.1 z)^2.
  double squares = 0, count = 0;
  for (Index t = 0; t < run.times; ++t) {
    for (Index cell = 0; cell < run.cells; ++cell) {
      const double z = run.memory->at(analysis::CellQuantity::centre, t, cell, 2) / run.radius - 6;
      if (std::abs(z) > 4) continue;
      squares += z * z;
      count += 1;
    }
  }
  const auto uniform = analysis::analyse(record, {.wall_layer = 2, .mean_flow = analysis::MeanFlow::uniform, .discard = 0});
  const double excess = uniform.estimate("velocity_variance_x").value - measured.estimate("velocity_variance_x").value;
  CHECK(excess == Approx(0.01 * squares / count).epsilon(0.1));
  CHECK(uniform.estimate("velocity_variance_y").value == measured.estimate("velocity_variance_y").value);
}

TEST_CASE("analysis: densities and their core and tails", "[analysis]") {
  SyntheticRun run{.times = 3000, .cells = 30};
  const auto found = analysis::analyse(run.record(), from_start);
  const auto& density = found.curve("pdf_velocity_y");
  REQUIRE(density.x.size() == 60);
  CHECK(density.value.sum() * (density.x[1] - density.x[0]) == Approx(1).epsilon(1e-3));
  const auto& fit = found.fit("pdf_velocity_y_core_and_tails").fit;
  agrees(fit.parameter("core_width"), 0.1);
  agrees(fit.parameter("core_centre"), 0);
  agrees(fit.parameter("core_height"), 1 / (0.1 * std::sqrt(2 * std::numbers::pi)));
  CHECK(fit.parameter("gaussian_tail").value == Approx(1).epsilon(0.2));
  CHECK(fit.parameter("upper_start").value == Approx(0.2).epsilon(0.1));
  CHECK(fit.parameter("lower_start").value == Approx(-0.2).epsilon(0.1));
  CHECK(fit.parameter("lower_decay").value > 0);
  for (const char* name : {"profile_variance_x", "profile_variance_y", "profile_variance_z"}) {
    const auto& variance = found.curve(name);
    const double truth = std::pow(run.deviation[name[17] - 'x'], 2);
    CAPTURE(name);
    CHECK(variance.value.segment(4, 16).mean() == Approx(truth).epsilon(0.1));
  }
}

TEST_CASE("analysis: the gap from variances, viscosity and volume fraction", "[analysis]") {
  SyntheticRun run{.times = 3000, .cells = 60, .viscosity = 4};
  const auto found = analysis::analyse(run.record(), from_start);
  const double phi = found.estimate("phi_bulk").value, viscosity = found.estimate("relative_viscosity").value;
  double sum = 0;
  for (const char* axis : {"x", "y", "z"}) sum += found.estimate(std::string("velocity_variance_") + axis).value;
  const auto& gap = found.estimate("gap_size");
  CHECK(gap.value == Approx(std::sqrt(sum / ((viscosity - 1) / (1 - phi) - 1))));
  CHECK(gap.error > 0);
  CHECK(gap.error < 0.1 * gap.value);
  CHECK(found.estimate("gap_size_lattice").value == Approx(5 * gap.value));
}

TEST_CASE("analysis: one cell, few samples, a gap in the samples, a drift", "[analysis]") {
  SyntheticRun single{.times = 300, .cells = 1};
  single.deviation[2] = 0;
  const auto alone = analysis::analyse(single.record(), {.wall_layer = 0, .discard = 0});
  for (const char* name : {"velocity_variance_x", "relaxation_time_y", "diffusivity_msd_z", "gap_size", "contact_number"}) {
    CAPTURE(name);
    CHECK(std::isnan(alone.estimate(name).value));
    CHECK(says(alone.estimate(name).reason, "one cell"));
  }
  CHECK(alone.estimate("deformation").value == Approx(0.5));

  for (const Index times : {1, 2, 3, 5, 9}) {
    SyntheticRun run{.times = times, .cells = 12};
    const auto found = analysis::analyse(run.record(), {.wall_layer = 2});
    CAPTURE(times);
    CHECK_FALSE(found.start_up.converged);
    for (const auto& item : found.estimates) {
      CAPTURE(item.name, item.estimate.value, item.estimate.reason);
      CHECK((item.group == analysis::Group::drift || !item.estimate.converged));
      CHECK(item.estimate.converged == item.estimate.reason.empty());
    }
    for (const auto& item : found.curves) {
      CAPTURE(item.name, item.curve.reason);
      CHECK_FALSE(item.curve.converged);
      CHECK_FALSE(item.curve.reason.empty());
    }
    for (const auto& item : found.fits) {
      CAPTURE(item.name);
      CHECK_FALSE(item.fit.converged);
      CHECK_FALSE(item.fit.reason.empty());
    }
    CHECK(std::isfinite(found.estimate("velocity_variance_y").value));
    CHECK(says(found.estimate("diffusivity_msd_y").reason, "too few"));
  }

  // 40 samples of series that last 33: profiles and densities are as doubtful as their numbers, also when the start-up is known.
  SyntheticRun brief{.times = 40, .cells = 12, .decay = 0.97};
  const auto doubtful = analysis::analyse(brief.record(), from_start);
  for (const char* name : {"profile_velocity", "profile_variance_y", "pdf_velocity_z", "profile_stress_xz"}) {
    CAPTURE(name, doubtful.curve(name).reason);
    CHECK(doubtful.curve(name).value.size() > 0);
    CHECK(says(doubtful.curve(name).reason, "shorter than 20 correlation times"));
  }

  SyntheticRun run{.times = 3000, .cells = 30};
  auto record = run.record();
  run.memory->remove(1000, 1400);
  for (auto* series : {&record.relative_viscosity, &record.mean_deformation}) std::fill(series->begin() + 1000, series->begin() + 1400, statistics::not_a_number);
  const auto gappy = analysis::analyse(record, from_start);
  agrees(gappy.estimate("velocity_variance_y"), 0.01);
  agrees(gappy.estimate("diffusivity_msd_y"), run.diffusivity(1));
  agrees(gappy.estimate("diffusivity_vacf_y"), run.diffusivity(1) * (1 - std::exp(-6.0)));
  CHECK(gappy.estimate("deformation").value == Approx(0.5));
  CHECK(gappy.warnings.empty());

  for (Index t = 0; t < run.times; ++t)
    for (Index cell = 0; cell < run.cells; ++cell) run.memory->at(analysis::CellQuantity::velocity, t, cell, 1) += 0.05 * run.radius * run.shear_rate;
  const auto drifting = analysis::analyse(record, from_start);
  REQUIRE(drifting.warnings.size() == 1);
  CHECK(says(drifting.warnings[0], "drift along y"));
  agrees(drifting.estimate("velocity_variance_y"), 0.01);
}

TEST_CASE("analysis: errors cover the truth in two of three runs", "[analysis][slow]") {
  std::map<std::string, Coverage> coverages;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SyntheticRun run{.times = 2000, .cells = 10, .seed = seed};
    run.deviation[2] = 0;  // with every cell in the bulk the truth is known
    const auto found = analysis::analyse(run.record(), {.wall_layer = 0, .discard = 0});
    const std::map<std::string, double> truths{{"relative_viscosity", 1.8},
                                               {"velocity_variance_y", 0.01},
                                               {"shear_rate_bulk", 0.9},
                                               {"relaxation_time_y", run.relaxation_time() * (1 - std::exp(-6.0))},
                                               {"diffusivity_vacf_y", run.diffusivity(1) * (1 - std::exp(-6.0))},
                                               {"diffusivity_msd_y", run.diffusivity(1)},
                                               {"stress_fluctuation", 0.3},
                                               {"stress_relaxation_time", run.relaxation_time()}};
    for (const auto& [name, truth] : truths) coverages[name].add(found.estimate(name).value, found.estimate(name).error, truth);
  }
  for (const auto& [name, coverage] : coverages) {
    CAPTURE(name);
    check(coverage);
  }
}
