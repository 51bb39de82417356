// A red cell stretched by optical tweezers, from a scene in SI units: one force of the experiment (all of them: cases/stretching.py).
#include <cmath>
#include <filesystem>

#include "io/scene.hpp"
#include "physics/packing.hpp"
#include "physics/suspension.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

TEST_CASE("A red cell stretched by 193 pN has the diameters that Mills et al. measured", "[stretching]") {
  // Mills et al., Mech. Chem. Biosyst. 1, 169 (2004): 15.29 +- 1 um and 4.27 +- 0.7 um. The error bars of the experiment are the tolerance; the
  // simulation's errors are smaller: 0.3 um by resolution (r = 6 against 8), under 0.05 um by what is left of the relaxation after 15 ms.
  const auto root = std::filesystem::absolute(std::filesystem::path(__FILE__)).parent_path().parent_path().parent_path();
  const Problem problem = read_scene((root / "scenes" / "stretching.toml").string(), {"cells.0.stretch.force=193 pN", "run.duration=15 ms"});
  const LatticeParameters lattice = to_lattice(problem);
  const auto types = make_cell_types(problem, lattice);
  const auto suspension = make_suspension(problem, lattice, types, place_cells(problem, lattice, types));
  const auto start = suspension->step_and_measure().cells[0];
  const double um = *lattice.si.length * 1e6;
  CHECK(start.extent[0] * um == Approx(2 * 3.91).epsilon(0.01));
  for (std::int64_t i = 1; i < lattice.steps * 4 / 5; ++i) suspension->step();
  const auto before = suspension->step_and_measure().cells[0];
  for (std::int64_t i = lattice.steps * 4 / 5 + 1; i < lattice.steps; ++i) suspension->step();
  suspension->check();
  const Sample sample = suspension->step_and_measure();
  const auto& cell = sample.cells[0];
  const double axial = cell.extent[0] * um, transverse = cell.extent[1] * um;
  UNSCOPED_INFO("axial " << axial << " um, transverse " << transverse << " um");
  CHECK(std::abs(axial - 15.29) < 1.0);
  CHECK(std::abs(transverse - 4.27) < 0.7);
  CHECK(std::abs(cell.extent[0] - before.extent[0]) * um < 0.05);  // at rest
  CHECK(std::abs(cell.extent[1] - before.extent[1]) * um < 0.05);
  CHECK(sample.volume_drift_max < 0.01);
  CHECK(sample.area_drift_max < 0.01);
}
