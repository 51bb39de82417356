// Whole coupled steps, through make_suspension: MLUPS and the share of each operator.
#include <fmt/format.h>

#include "perf/kernel_times.hpp"
#include "perf/red_cells.hpp"
#include "physics/suspension.hpp"

using namespace corpuscle;
using namespace corpuscle::perf;

namespace {

void measure(Section& section, const std::string& name, const SuspensionCase& c) {
  const auto suspension = make_suspension(c.problem, c.lattice, c.types, c.positions);
  const StepTimes times = step_times([&] { suspension->step(); }, section.effort().quick ? 1 : 3, section.effort().quick ? 2 : 8);
  suspension->check();
  Json row = {{"phi", c.lattice.phi_geometric},
              {"points", c.problem.accuracy.delta_kernel},
              {"cells", c.cells()},
              {"vertices", std::int64_t(c.vertices())},
              {"nodes", c.lattice.nodes},
              {"contact", c.problem.contact.enabled},
              {"MLUPS", c.nodes() / times.step / 1e6},
              {"step_ms", times.step * 1e3}};
  add_parts(row, times);
  row["spread_M_s"] = c.vertices() / times.parts.at("spread") / 1e6;
  row["interpolate_M_s"] = c.vertices() / times.parts.at("interpolate") / 1e6;
  row["membrane_M_s"] = c.vertices() / times.parts.at("membrane") / 1e6;
  section.row(name, row);
}

}  // namespace

int main(int argc, char** argv) {
  auto metrics = part_metrics();
  metrics.insert(metrics.begin(), {"MLUPS", "higher"});
  Section section(argc, argv, "step", "A whole coupled step: membrane, contact, spreading, fluid, interpolation, vertex motion.", metrics);
  Kokkos::ScopeGuard scope(argc, argv);

  const SuspensionSettings base = usual_settings(section.effort().quick);
  const std::array<int, 3> copies{2, 2, 1};
  section.note(fmt::format(
      "Red cells, r = {:g}, {} vertices; {} x {} x {} nodes between walls, sheared. Up to phi = 0.36 packed (a block of a quarter of the box, repeated along x "
      "and y), with contact; at phi = 0.6 at random places, overlapping, without contact, as packing would take minutes.",
      base.radius, 10 * base.subdivision * base.subdivision + 2, base.nodes[0], base.nodes[1], base.nodes[2]));
  const auto with = [&base](double phi, int points, Precision precision, Precision membrane) {
    SuspensionSettings s = base;
    s.phi = phi, s.points = points, s.precision = precision, s.membrane = membrane;
    return s;
  };
  constexpr auto single = Precision::single_precision, twice = Precision::double_precision;
  measure(section, "phi 0.05, 4-point, float, double membrane", packed_suspension(with(0.05, 4, single, twice), copies));
  const SuspensionCase packed = packed_suspension(with(0.36, 4, single, twice), copies);
  measure(section, "phi 0.36, 4-point, float, double membrane", packed);
  for (const int points : {4, 3, 2})
    measure(section, fmt::format("phi 0.36, {}-point, float, float membrane", points), with_positions_of(packed, with(0.36, points, single, single)));
  for (const int points : {4, 3, 2})
    measure(section, fmt::format("phi 0.36, {}-point, double, double membrane", points), with_positions_of(packed, with(0.36, points, twice, twice)));
  measure(section, "phi 0.6, 4-point, float, double membrane", random_suspension(with(0.6, 4, single, twice)));
  measure(section, "phi 0.6, 4-point, float, float membrane", random_suspension(with(0.6, 4, single, single)));
  return section.finish();
}
