// Cost of a step from 10 to 1000 cells at the same volume fraction: one packed block of 10 cells, repeated.
#include <fmt/format.h>

#include <cmath>

#include "perf/kernel_times.hpp"
#include "perf/red_cells.hpp"
#include "physics/suspension.hpp"

using namespace corpuscle;
using namespace corpuscle::perf;

int main(int argc, char** argv) {
  Section section(argc, argv, "growth", "Cost of a step over the number of cells, the same packed block repeated.", {{"us_per_cell", "lower"}});
  Kokkos::ScopeGuard scope(argc, argv);
  const bool quick = section.effort().quick;
  std::vector<std::array<int, 3>> boxes{{1, 1, 1}, {3, 1, 1}, {2, 2, 2}, {3, 3, 3}, {5, 5, 4}};
  if (quick) boxes.resize(3);
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const auto& copies : boxes) {
    SuspensionSettings s;
    s.membrane = Precision::single_precision;
    s.walls = false;
    const int block = quick ? 14 : 28;
    if (quick) s.radius = s.subdivision = 4;
    for (int k = 0; k < 3; ++k) s.nodes[k] = copies[k] * block;
    const SuspensionCase c = packed_suspension(s, copies);
    const auto suspension = make_suspension(c.problem, c.lattice, c.types, c.positions);
    const int steps = quick ? 2 : std::max(4, 2000 / c.cells());
    const StepTimes times = step_times([&] { suspension->step(); }, quick ? 1 : 4, steps);
    Json row = {{"cells", c.cells()}, {"nodes", c.lattice.nodes}, {"step_ms", times.step * 1e3}, {"us_per_cell", times.step * 1e6 / c.cells()}};
    add_parts(row, times);
    section.row(fmt::format("{} cells", c.cells()), row);
    const double x = std::log(c.cells()), y = std::log(times.step);
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  section.note(
      fmt::format("Step time grows with the number of cells to the power {:.2f}. Small boxes fit the caches.", (n * sxy - sx * sy) / (n * sxx - sx * sx)));
  return section.finish();
}
