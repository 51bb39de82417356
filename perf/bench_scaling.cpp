// Strong scaling: one dense step at the present number of threads. perf/run_benchmarks.py runs it for several and makes Amdahl's table.
#include <fmt/format.h>

#include "perf/kernel_times.hpp"
#include "perf/red_cells.hpp"
#include "physics/suspension.hpp"

using namespace corpuscle;
using namespace corpuscle::perf;

int main(int argc, char** argv) {
  auto metrics = part_metrics();
  metrics.insert(metrics.begin(), {"step_ms", "lower"});
  Section section(argc, argv, "scaling", "One dense step at several numbers of threads.", metrics);
  Kokkos::ScopeGuard scope(argc, argv);
  SuspensionSettings s = usual_settings(section.effort().quick);
  s.membrane = Precision::single_precision;
  const SuspensionCase c = packed_suspension(s, {4, 4, 2});
  const auto suspension = make_suspension(c.problem, c.lattice, c.types, c.positions);
  const StepTimes times = step_times([&] { suspension->step(); }, section.effort().quick ? 1 : 4, section.effort().quick ? 2 : 8);
  Json row = {{"threads", ExecSpace().concurrency()}, {"cells", c.cells()}, {"nodes", c.lattice.nodes}, {"step_ms", times.step * 1e3}};
  add_parts(row, times);
  section.row(fmt::format("threads: {}", ExecSpace().concurrency()), row);
  return section.finish();
}
