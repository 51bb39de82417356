// Membrane forces: vertices a second for each law, with and without bending, and with the global constraints of red cells, of capsules, and none.
#include <fmt/format.h>

#include <string>

#include "perf/red_cells.hpp"
#include "perf/timing.hpp"
#include "physics/membrane.hpp"

using namespace corpuscle;
using namespace corpuscle::perf;

int main(int argc, char** argv) {
  Section section(argc, argv, "membrane", "Membrane forces of red cells, deformed by some per cent.", {{"M_s", "higher"}});
  Kokkos::ScopeGuard scope(argc, argv);
  SuspensionSettings s = usual_settings(section.effort().quick);
  SuspensionCase c = random_suspension(s);
  for (std::size_t i = 0; i < c.positions.size(); ++i) c.positions[i] *= i % 3 == 0 ? 1.05 : i % 3 == 1 ? 0.97 : 1.0;
  const Cells cells(c.types, c.positions);
  for (const auto precision : {Precision::single_precision, Precision::double_precision})
    for (const auto law : {StrainLawKind::skalak, StrainLawKind::neo_hookean})
      for (const bool bending : {true, false})
        for (const std::string global : {", area, volume", ", volume", ""}) {
          MembraneModuli moduli = c.types[0].moduli;
          moduli.law = law;
          if (!bending) moduli.bending = 0;
          moduli.global_area = global.find("area") != std::string::npos ? 1 : 0;
          moduli.volume = global.empty() ? 0 : 1;
          const auto membrane = make_membrane(c.types[0].reference, moduli, precision, 0, c.cells());
          const double seconds = best_of([&] { membrane->compute_forces(cells.positions(), cells.forces()); }, section.effort());
          section.row(fmt::format("{} {}{}{}", precision == Precision::single_precision ? "float" : "double",
                                  law == StrainLawKind::skalak ? "Skalak" : "neo-Hookean", bending ? ", bending" : "", global),
                      {{"cells", c.cells()}, {"vertices", std::int64_t(c.vertices())}, {"M_s", c.vertices() / seconds / 1e6}});
        }
  return section.finish();
}
