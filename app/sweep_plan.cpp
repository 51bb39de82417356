#include "app/sweep_plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <limits>
#include <map>
#include <set>

#include "app/calibrate.hpp"
#include "app/commands.hpp"
#include "core/error.hpp"
#include "io/scene.hpp"
#include "physics/memory.hpp"

namespace corpuscle::app {
namespace {

PlannedPoint plan_point(const std::string& scene, const SweepPoint& point) {
  PlannedPoint planned;
  planned.point = point;
  planned.problem = read_scene(scene, point.texts());
  planned.lattice = to_lattice(planned.problem);
  for (const auto& type : planned.lattice.cells) planned.cells += type.count;
  planned.bytes = double(predict_memory(planned.problem, planned.lattice).peak());
  return planned;
}

/// Scenes with the same text cost the same a node and a vertex.
std::string kind_of(const Problem& problem) {
  Problem kind = problem;
  kind.flow.capillary_number.reset();
  kind.flow.capillary_number_G.reset();
  kind.flow.reynolds_number_max = FlowSpec{}.reynolds_number_max;
  kind.accuracy.shear_modulus.reset();
  kind.accuracy.shear_rate.reset();
  kind.si = {};
  kind.guards = {};
  kind.run = {};
  kind.output = {};
  return to_toml(kind);
}

[[noreturn]] void measure(int pipe, const std::vector<const PlannedPoint*>& points, const std::vector<std::size_t>& which, int threads) {
  int code = 1;
  try {
    const KokkosSession session(threads);
    std::map<std::string, Calibration> known;
    for (const std::size_t i : which) {
      const std::string kind = kind_of(points[i]->problem);
      if (!known.contains(kind)) known[kind] = calibrate(points[i]->problem, points[i]->lattice);
      const double seconds = known[kind].seconds_per_step(points[i]->lattice);
      if (::write(pipe, &seconds, sizeof seconds) != sizeof seconds) break;
    }
    code = 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "warning: the speed of this machine could not be measured: %s\n", error.what());
  }
  ::_exit(code);
}

}  // namespace

std::vector<PlannedPoint> plan_points(const Sweep& sweep, std::vector<RefusedPoint>* refused) {
  constexpr std::size_t most_told = 50;
  std::vector<PlannedPoint> planned;
  std::vector<std::string> problems;
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    try {
      planned.push_back(plan_point(sweep.scene, sweep.points[i]));
    } catch (const InputError& error) {
      problems.push_back(fmt::format("\n  {}: {}", sweep.points[i].name, error.what()));
      if (refused != nullptr) refused->push_back({i, error.what()});
    }
  }
  if (problems.empty() || (refused != nullptr && !planned.empty())) return planned;
  const std::size_t told = std::min(problems.size(), most_told);
  throw InputError(fmt::format("{} of {} points can't be run, so nothing was started:{}{}", problems.size(), sweep.points.size(),
                               fmt::join(problems.begin(), problems.begin() + static_cast<std::ptrdiff_t>(told), ""),
                               problems.size() > told ? fmt::format("\n  and {} more", problems.size() - told) : ""));
}

std::vector<std::string> warnings_of(const std::vector<PlannedPoint>& points) {
  std::map<std::string, std::vector<std::string>> names;
  for (const PlannedPoint& p : points)
    for (const std::string& text : p.lattice.warnings) names[text].push_back(p.point.name);
  std::vector<std::string> warnings;
  for (const auto& [text, about] : names)
    warnings.push_back(fmt::format("{}{}: {}", about.front(), about.size() > 1 ? fmt::format(" and {} more points", about.size() - 1) : "", text));
  return warnings;
}

std::vector<double> seconds_per_step(const std::vector<const PlannedPoint*>& points, const std::vector<int>& threads) {
  std::vector<double> seconds(points.size(), std::numeric_limits<double>::quiet_NaN());
  for (const int count : std::set<int>(threads.begin(), threads.end())) {
    std::vector<std::size_t> which;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (threads[i] == count) which.push_back(i);
    int ends[2];
    if (::pipe(ends) != 0) throw OutputError("sweep: no pipe for the process that measures");
    std::cout << std::flush;
    std::fflush(nullptr);
    const pid_t child = ::fork();
    if (child < 0) throw OutputError("sweep: no process that measures");
    if (child == 0) {
      ::close(ends[0]);
      measure(ends[1], points, which, count);
    }
    ::close(ends[1]);
    for (const std::size_t i : which)
      if (::read(ends[0], &seconds[i], sizeof(double)) != sizeof(double)) {
        seconds[i] = std::numeric_limits<double>::quiet_NaN();
        break;
      }
    ::close(ends[0]);
    ::waitpid(child, nullptr, 0);
  }
  return seconds;
}

}  // namespace corpuscle::app
