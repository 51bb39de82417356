// Any text as a scene: it's refused with InputError, or gives a Problem that survives to_toml() and becomes lattice parameters.
#include <cmath>
#include <string_view>

#include "core/error.hpp"
#include "io/scene.hpp"
#include "physics/units.hpp"
#include "tests/fuzz/require.hpp"

namespace {

/// Meshes of large cells take long to build, and are no business of a parser.
bool small(const corpuscle::Problem& problem) {
  if (problem.accuracy.radius > 12 || problem.cells.size() > 2) return false;
  if (problem.accuracy.subdivision && *problem.accuracy.subdivision > 20) return false;
  for (const auto& cell : problem.cells)
    if (cell.relative_radius > 1.5 || !cell.file.empty()) return false;
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace corpuscle;
  const std::string_view text(reinterpret_cast<const char*>(bytes), size);
  Problem problem;
  try {
    problem = parse_scene(text, "scene.toml");
  } catch (const InputError&) {
    return 0;
  }
  const std::string merged = to_toml(problem);
  CORPUSCLE_REQUIRE(to_toml(parse_scene(merged, "merged.toml")) == merged);
  if (!small(problem)) return 0;
  try {
    const LatticeParameters lattice = to_lattice(problem);
    for (const int n : lattice.nodes) CORPUSCLE_REQUIRE(n > 0);
    CORPUSCLE_REQUIRE(lattice.steps > 0 && lattice.series_every > 0 && lattice.snapshot_every >= 0);
    CORPUSCLE_REQUIRE(std::isfinite(lattice.relaxation_time) && std::isfinite(lattice.shear_rate));
  } catch (const InputError&) {
  }
  return 0;
}
