// Packing, and contact forces in what it packed: with the lists kept, and with lists that are rebuilt at every call.
#include <fmt/format.h>

#include <algorithm>

#include "perf/red_cells.hpp"
#include "perf/timing.hpp"
#include "physics/contact.hpp"
#include "physics/packing.hpp"

using namespace corpuscle;
using namespace corpuscle::perf;

int main(int argc, char** argv) {
  Section section(argc, argv, "contact", "Seconds of a packing; contact forces in it.",
                  {{"packing_s", "lower"}, {"kept_M_s", "higher"}, {"rebuilt_M_s", "higher"}, {"pairs_M_s", "higher"}});
  Kokkos::ScopeGuard scope(argc, argv);
  SuspensionSettings s;
  s.points = 3;
  s.walls = false;
  s.nodes = {64, 64, 64};
  if (section.effort().quick) {
    s.nodes = {20, 20, 20};
    s.radius = s.subdivision = 4;
  }
  s.phi = 0.36;  // phi_eff about 0.45 at r = 8
  SuspensionCase c = suspension_case(s);
  int rounds = 0;
  const Kokkos::Timer timer;
  c.positions = place_cells(c.problem, c.lattice, c.types, [&](double, double, int round) { return rounds = round, true; });
  const double packing = timer.seconds();

  const Cells cells(c.types, c.positions);
  for (double& x : c.positions) x += 0.4;  // more than half a skin: lists are built anew
  const Cells moved(c.types, c.positions);
  const PeriodicBox box(Grid{s.nodes[0], s.nodes[1], s.nodes[2], 1}, s.walls);
  const ContactParameters parameters{c.lattice.contact_strength, c.lattice.contact_range};
  Contact contact(box, parameters, cells.cell_of_vertex()), restless(box, parameters, cells.cell_of_vertex());
  const auto seconds = interleaved_seconds({[&] { contact.add_forces(cells.positions(), cells.forces()); },
                                            [&] {
                                              restless.add_forces(moved.positions(), cells.forces());
                                              restless.add_forces(cells.positions(), cells.forces());
                                            }},
                                           section.effort());
  // Rows name each pair twice.
  const auto begin = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, contact.neighbours().begin);
  const double vertices = c.vertices(), pairs = begin(begin.extent(0) - 1) / 2;
  const std::string title = fmt::format("phi_eff {:.2f}, {} cells", c.lattice.phi_effective, c.cells());
  section.row(title, {{"cells", c.cells()},
                      {"vertices", std::int64_t(vertices)},
                      {"phi", c.lattice.phi_geometric},
                      {"packing_s", packing},
                      {"rounds", rounds},
                      {"pairs_per_vertex", pairs / vertices},
                      {"kept_M_s", vertices / seconds[0] / 1e6},
                      {"pairs_M_s", pairs / seconds[0] / 1e6},
                      {"rebuilt_M_s", 2 * vertices / seconds[1] / 1e6}});
  return section.finish();
}
