#include "physics/stability_probe.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "core/random.hpp"
#include "physics/membrane.hpp"
#include "physics/suspension.hpp"

namespace corpuscle {
namespace {

constexpr double displacement = 1e-3;    // small against every length, large against rounding
constexpr double hopeless = 1e4;         // growth of the jitter after which nothing more can be learnt
constexpr double quiet = 1e-7;           // and decay
constexpr double slowest_growth = 3e-6;  // per step: runs last up to a million steps
// In flow, jitter relative to gamma_dot r. Resolved motion has about gamma_dot, below 1e-3. Growth counts from `suspicious` on; `drowned` is no flow any more.
constexpr double suspicious = 0.003, drowned = 1;  // the first for each step between two couplings
constexpr double chance = 1.1;           // growth over the last half of a probe (log 3) that resolved motion may have

double rms_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / (double(a.size()) / 3));
}

/// Couples so many times and returns the mean jitter, from pairs of neighbouring couplings spread over this window.
double jitter_over(Suspension& suspension, std::int64_t couplings) {
  constexpr int pairs = 8;
  double sum = 0;
  std::int64_t done = 0;
  for (int pair = 1; pair <= pairs; ++pair) {
    const std::int64_t until = couplings * pair / pairs;
    for (; done < until - 1; ++done) suspension.step();
    const auto before = suspension.snapshot(false).velocities;
    suspension.step();
    ++done;
    sum += rms_difference(suspension.snapshot(false).velocities, before);
    suspension.check();
  }
  return sum / pairs;
}

double elastic_energy(const CellType& type, const std::vector<double>& positions) {
  std::vector<Vector3> vertices(type.vertices());
  for (int v = 0; v < type.vertices(); ++v)
    for (int k = 0; k < 3; ++k) vertices[v][k] = positions[3 * std::size_t(type.first_vertex + v) + k];
  return membrane_energy(type.reference, type.moduli, vertices).total();
}

/// Slope of log(values) over the last half, per window.
double late_slope(const std::vector<double>& values) {
  const std::size_t first = values.size() / 2;
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = first; i < values.size(); ++i) {
    const double x = double(i), y = std::log(std::max(values[i], 1e-300));
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return n > 1 ? (n * sxy - sx * sy) / (n * sxx - sx * sx) : 0;
}

/// The jitter of each window over `unit`, until `clear` says that the verdict is; fills steps, jitter and growth rate of the verdict. Empty when a guard tripped: that is the verdict.
template <class Clear>
std::vector<double> watch(Suspension& suspension, const ProbeLength& length, double unit, StabilityVerdict& verdict, const Clear& clear) {
  const std::int64_t window = std::max<std::int64_t>(16, length.steps / length.windows);
  std::vector<double> jitter;
  try {
    for (int w = 0; w < length.windows; ++w) {
      jitter.push_back(jitter_over(suspension, window) / unit);
      verdict.steps += window;
      if (clear(jitter)) break;
    }
  } catch (const SimulationError& broken) {
    const std::string what = broken.what();
    verdict.reason = what.substr(0, what.find(". "));
    return {};
  }
  verdict.jitter = jitter.back();
  verdict.growth_rate = late_slope(jitter) / double(window);
  return jitter;
}

}  // namespace

void displace(std::vector<double>& positions, double length, std::uint64_t seed) {
  RandomStream random(seed);
  for (double& x : positions) x += random.uniform(-length, length);
}

StabilityVerdict probe_at_rest(const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types, std::vector<double> positions,
                               const ProbeLength& length) {
  displace(positions, displacement, 1);
  const auto suspension = make_suspension(problem, lattice, types, positions);
  const double energy = elastic_energy(types[0], positions);
  StabilityVerdict verdict;
  const auto jitter = watch(*suspension, length, 1, verdict, [](const std::vector<double>& j) { return j.back() > hopeless * j[0] || j.back() < quiet * j[0]; });
  if (jitter.empty()) return verdict;
  const double ratio = elastic_energy(types[0], suspension->snapshot(false).positions) / energy;
  const bool decayed = jitter.back() < quiet * jitter[0];
  if (!decayed && (verdict.growth_rate > slowest_growth || jitter.back() > hopeless * jitter[0])) verdict.reason = "velocity noise grows";
  else if (!(ratio < 1)) verdict.reason = "the elastic energy grows";
  else {
    verdict.stable = true;
    verdict.reason = "relaxes";
  }
  return verdict;
}

StabilityVerdict probe_in_flow(const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types, const std::vector<double>& positions,
                               const ProbeLength& length) {
  const auto suspension = make_suspension(problem, lattice, types, positions);
  suspension->settle();  // as runs do: the packed state knows nothing of these moduli
  StabilityVerdict verdict;
  const auto jitter = watch(*suspension, length, lattice.shear_rate * lattice.radius, verdict,
                            [](const std::vector<double>& j) { return j.size() > 1 && j.back() > 3 * drowned; });
  if (jitter.empty()) return verdict;
  const double growth = verdict.growth_rate * double(verdict.steps) / 2;
  if (jitter.back() > drowned) verdict.reason = "velocity noise above the shear velocity";
  else if (jitter.back() > suspicious * lattice.coupling_every && growth > chance) verdict.reason = "velocity noise grows";
  else {
    verdict.stable = true;
    verdict.reason = "velocity noise stays small";
  }
  return verdict;
}

}  // namespace corpuscle
