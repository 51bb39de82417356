// What each optional model costs where it is used: launches, bytes, and the time of a step with it against one without, in turns in one process (docs/models.md).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <set>

#include "core/kernel_log.hpp"
#include "io/run_file.hpp"
#include "perf/optional_models.hpp"
#include "perf/report.hpp"
#include "physics/live_statistics.hpp"
#include "physics/packing.hpp"
#include "physics/suspension.hpp"

using namespace corpuscle;
using namespace corpuscle::perf;

namespace {

using Call = std::function<void()>;

struct Running {
  Problem problem;
  LatticeParameters lattice;
  std::unique_ptr<Suspension> suspension;
};

/// @param positions of the cells, the same for all that have cells
Running start(const Problem& problem, const std::vector<double>& positions) {
  Running r{problem, to_lattice(problem), nullptr};
  auto types = make_cell_types(r.problem, r.lattice);
  const bool cells = !types.empty();
  r.suspension = make_suspension(r.problem, r.lattice, std::move(types), cells ? positions : std::vector<double>{});
  return r;
}

/// Time of the processor, which other processes don't lengthen; of a device the host's clock.
double seconds_now() {
  Kokkos::fence();
  static const Kokkos::Timer timer;
  return runs_on_host ? double(std::clock()) / CLOCKS_PER_SEC : timer.seconds();
}

/// Time of `with` over that of `without`: median and quartiles over the rounds.
struct TimeRatio {
  double median = 1, low = 1, high = 1;
};

/// Rounds of a stretch with, two without, one with: what changes slowly cancels.
TimeRatio time_ratio(const Call& with, const Call& without, const Effort& effort) {
  const auto stretch = [](const Call& call, int calls) {
    const double from = seconds_now();
    for (int i = 0; i < calls; ++i) call();
    return seconds_now() - from;
  };
  for (int i = 0; i < 2; ++i) with(), without();
  const double once = std::max(1e-6, stretch(without, 2) / 2);
  const int calls = effort.quick ? 2 : std::max(2, int(effort.min_seconds / once / 2) * 2);  // even: the two parities of streaming differ
  std::vector<double> ratios;
  for (int round = 0; round < (effort.quick ? 1 : 16); ++round) {
    double a = stretch(with, calls), b = stretch(without, calls);
    b += stretch(without, calls), a += stretch(with, calls);
    ratios.push_back(a / b);
  }
  std::sort(ratios.begin(), ratios.end());
  const auto at = [&](double q) { return ratios[std::size_t(q * double(ratios.size() - 1) + 0.5)]; };
  return {at(0.5), at(0.25), at(0.75)};
}

std::vector<std::string> kernels_of(const Call& call) {
  for (int i = 0; i < 3; ++i) call();
  KernelLog log;
  call();
  std::vector<std::string> labels;
  for (const auto& launch : log.launches())
    if (launch.label.rfind("Kokkos::", 0) != 0) labels.push_back(launch.label);  // filling an array is no kernel of ours
  return labels;
}

Json launches(const Call& with, const Call& without) {
  const auto a = kernels_of(with), b = kernels_of(without);
  const std::set<std::string> others(b.begin(), b.end());
  std::string names;
  std::set<std::string> seen;
  for (const auto& label : a)
    if (!others.contains(label) && seen.insert(label).second) names += (names.empty() ? "" : "; ") + label;
  return {{"launches_with", a.size()}, {"launches_without", b.size()}, {"kernels", names}};
}

class Table {
 public:
  Table(Section& section, const Problem& usual) : section_(section) {
    const LatticeParameters lattice = to_lattice(usual);
    positions_ = place_cells(usual, lattice, make_cell_types(usual, lattice));
    usual_ = start(usual, positions_);
    vertices_ = double(positions_.size()) / 3;
    section.note(fmt::format("{} red cells, r = {:g}, {} vertices, phi_eff = {:.2f}; {} x {} x {} nodes; {}-point kernel, float, double membrane.",
                             lattice.cells[0].count, lattice.radius, vertices_, lattice.phi_effective, lattice.nodes[0], lattice.nodes[1], lattice.nodes[2], usual.accuracy.delta_kernel));
  }

  void model(const OptionalModel& model) {
    const Running with = variant(model.with), without = variant(model.without);
    const double bytes = double(with.suspension->bytes()) - double(without.suspension->bytes());
    const bool fluid_alone = with.problem.cells.empty();
    row(model.name, model.left_out_by, [&] { with.suspension->step(); }, [&] { without.suspension->step(); },
        bytes / (fluid_alone ? with.lattice.box_volume() : vertices_), fluid_alone ? "node" : "vertex");
  }

  /// What is done beside some steps: its cost is that of doing it at every step. @param every steps between two by default
  void activity(const std::string& name, const std::string& left_out_by, const Call& with, const Call& without, double bytes, const std::string& per, double every) {
    row(name, left_out_by, with, without, bytes, per, every);
  }

  const Running& usual() const { return usual_; }

 private:
  Running variant(const std::function<void(Problem&)>& change) const {
    Problem problem = usual_.problem;
    change(problem);
    return start(problem, positions_);
  }
  void row(const std::string& name, const std::string& left_out_by, const Call& with, const Call& without, double bytes, const std::string& per, double every = 1) {
    Json values{{"left_out_by", left_out_by}};
    values.update(launches(with, without));
    const TimeRatio ratio = time_ratio(with, without, section_.effort());
    values.update({{"bytes", rounded(bytes)}, {"bytes_per", per}, {"time_ratio", 1e-4 * std::round(1e4 * ratio.median)}, {"time_ratio_low", 1e-4 * std::round(1e4 * ratio.low)},
                   {"time_ratio_high", 1e-4 * std::round(1e4 * ratio.high)}, {"every", rounded(every)}});
    section_.row(name, values);
  }

  Section& section_;
  std::vector<double> positions_;
  Running usual_;
  double vertices_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  Section section(argc, argv, "models", "What each model that a scene may leave out costs where it is used: time of a step with it over one without.", {{"time_ratio", "lower"}});
  Kokkos::ScopeGuard scope(argc, argv);
  const bool quick = section.effort().quick;
  Table table(section, usual_scene(quick ? 4 : 6, quick ? 4 : 8, quick ? 0.25 : 0.3));
  for (const auto& model : optional_models()) table.model(model);

  const Running& usual = table.usual();
  Suspension& s = *usual.suspension;
  const auto step = [&] { s.step(); };
  const double series = double(usual.lattice.series_every), cells = double(usual.lattice.cells[0].count);
  table.activity("guards", "cannot be left out", [&] { s.step(), s.check(); }, step, 0, "-", double(usual.lattice.guard_every));
  table.activity("sample of the series", "cannot be left out", [&] { s.step_and_measure(); }, step, 0, "-", series);
  table.activity("velocity of the fluid for a snapshot", "`output.fluid = false`", [&] { s.step(), s.snapshot(true); }, [&] { s.step(), s.snapshot(false); }, 0, "-", 20 * series);

  const std::filesystem::path folder = std::filesystem::temp_directory_path() / fmt::format("corpuscle_bench_models_{}", std::clock());
  std::filesystem::create_directories(folder);
  {
    const RunMetadata metadata{to_toml(usual.problem), "", "", "", 1, "", ""};
    RunFile all(folder / "all.h5", metadata, usual.lattice, {.trajectories = true}), series_only(folder / "series.h5", metadata, usual.lattice, {.trajectories = false});
    const auto record = [&](RunFile& file) {
      file.append(s.step_and_measure());
      if (file.samples() % 50 == 0) file.flush();
    };
    table.activity("trajectories", "`output.trajectories = false`", [&] { record(all); }, [&] { record(series_only); }, 26 * 8, "cell and sample, in run.h5", series);
  }
  std::filesystem::remove_all(folder);
  LiveStatistics statistics(usual.lattice, usual.problem.box.walls, 0);
  std::int64_t samples = 0;
  const auto add = [&] {
    Sample sample = s.step_and_measure();
    sample.step = samples++ * usual.lattice.series_every;
    statistics.add(sample);
  };
  const double bytes = double(LiveStatistics::predicted_bytes(std::size_t(cells)));
  table.activity("statistics while the run goes on", "`output.statistics = false`", add, [&] { s.step_and_measure(); }, bytes / cells, "cell", series);
  return section.finish();
}
