// Spreading and interpolation in markers a second. Spreading three ways in turns: the default of this backend, atomics, and the textbook's serial loop.
#include <fmt/format.h>

#include <stdexcept>

#include "core/huge_pages.hpp"
#include "perf/red_cells.hpp"
#include "perf/textbook_spread.hpp"
#include "perf/timing.hpp"
#include "physics/coupling.hpp"

using namespace corpuscle;
using namespace corpuscle::perf;

namespace {

template <class Real>
void measure(Section& section, const std::string& name, const SuspensionCase& c, int points, bool walls) {
  const Grid grid{c.lattice.nodes[0], c.lattice.nodes[1], c.lattice.nodes[2], Coupling<Real>::halo_width(points)};
  const Cells cells(c.types, c.positions);
  const auto x = cells.positions(), F = cells.forces(), u = cells.velocities();
  Kokkos::deep_copy(F, 1e-4);
  const std::vector<double> forces(c.positions.size(), 1e-4);
  const auto field = zeros_on_huge_pages<VectorField<Real>>("force", grid.padded_nodes());  // as in a fluid
  const auto atomic_field = zeros_on_huge_pages<VectorField<Real>>("atomic_force", grid.padded_nodes());
  std::vector<Real> serial_field(4 * grid.padded_nodes(), Real(0));
  Coupling<Real> coupling(grid, walls, points), atomic(grid, walls, points, SpreadMode::atomic);

  // The three do the same, up to the order of their sums.
  coupling.spread(x, F, field);
  textbook_spread(grid, points, c.positions, forces, serial_field.data());
  const auto copy = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, field);
  for (std::size_t n = 0; n < grid.padded_nodes(); ++n)
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(double(copy(n, k)) - double(serial_field[4 * n + k])) < 1e-4 * (1e-4 + std::abs(double(copy(n, k))))))
        throw std::runtime_error("bench_coupling: spread differs from the textbook's at node " + std::to_string(n));

  const auto seconds =
      interleaved_seconds({[&] { coupling.spread(x, F, field); }, [&] { atomic.spread(x, F, atomic_field); },
                           [&] { textbook_spread(grid, points, c.positions, forces, serial_field.data()); }, [&] { coupling.interpolate(x, u, field); }},
                          section.effort());
  const double markers = c.vertices();
  const std::string title = fmt::format("{}, {}-point, {}", name, points, sizeof(Real) == 4 ? "float" : "double");
  section.row(title, {{"markers", std::int64_t(markers)},
                      {"nodes", c.lattice.nodes},
                      {"spread_M_s", markers / seconds[0] / 1e6},
                      {"interpolate_M_s", markers / seconds[3] / 1e6},
                      {"atomic_M_s", markers / seconds[1] / 1e6},
                      {"serial_M_s", markers / seconds[2] / 1e6},
                      {"over_atomic", seconds[1] / seconds[0]},
                      {"over_serial", seconds[2] / seconds[0]}});
}

}  // namespace

int main(int argc, char** argv) {
  Section section(argc, argv, "coupling",
                  "Markers of red cells at random places. over_atomic, over_serial: how many times faster spreading is than with atomics and than the "
                  "textbook's serial loop.",
                  {{"spread_M_s", "higher"}, {"interpolate_M_s", "higher"}});
  Kokkos::ScopeGuard scope(argc, argv);
  SuspensionSettings s = usual_settings(section.effort().quick);
  const SuspensionCase dense = random_suspension(s);
  for (const int points : {2, 3, 4}) {
    measure<float>(section, "phi 0.36", dense, points, true);
    measure<double>(section, "phi 0.36", dense, points, true);
  }
  // Where work is hard to share out: few planes, most of the box empty, one cell in all of it.
  SuspensionSettings quarter = s;
  quarter.phi = 0.09;
  measure<float>(section, "phi 0.09, everywhere", random_suspension(quarter), 4, true);
  measure<float>(section, "phi 0.09, lowest quarter of the box", random_suspension(quarter, 0, 0.25), 4, true);
  SuspensionSettings thin = s;
  thin.nodes = section.effort().quick ? std::array{32, 32, 8} : std::array{512, 512, 8};
  thin.walls = false;
  thin.radius = thin.subdivision = 4;
  measure<float>(section, "thin box, 8 nodes high", random_suspension(thin), 4, false);
  SuspensionSettings one = s;
  one.nodes = {section.effort().quick ? 24 : 64, section.effort().quick ? 24 : 64, section.effort().quick ? 24 : 64};
  one.radius = one.subdivision = section.effort().quick ? 10 : 28;
  one.phi = 1e-6;  // one cell
  measure<float>(section, "one large cell", random_suspension(one), 4, true);
  return section.finish();
}
