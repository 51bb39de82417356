// Initial positions up to the densest suspensions: no overlap, volumes kept, the same for the same seed.
#include "physics/packing.hpp"

#include <cmath>

#include "core/error.hpp"
#include "io/scene.hpp"
#include "physics/overlap.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

namespace {

struct Packed {
  std::vector<CellType> types;
  std::vector<double> positions;
  OverlapReport overlap;
  double volume_drift = 0, area_drift = 0;
  double phi_effective = 0;
};

Packed pack(const std::string& scene) {
  const Problem problem = parse_scene(scene, "packing.toml");
  const LatticeParameters lattice = to_lattice(problem);
  Packed p;
  p.types = make_cell_types(problem, lattice);
  p.positions = place_cells(problem, lattice, p.types);
  p.phi_effective = lattice.phi_effective;
  CellGeometry geometry;
  for (int k = 0; k < 3; ++k) geometry.box[k] = lattice.nodes[k];
  geometry.walls_z = problem.box.walls;
  for (const auto& type : p.types)
    for (int c = 0; c < type.count; ++c) {
      const double* x = &p.positions[3 * (std::size_t(type.first_vertex) + std::size_t(c) * type.vertices())];
      geometry.cells.push_back({x, type.vertices(), &type.reference.faces});
      Mesh mesh{{}, type.reference.faces};
      for (int v = 0; v < type.vertices(); ++v) mesh.vertices.emplace_back(x[3 * v], x[3 * v + 1], x[3 * v + 2]);
      p.volume_drift = std::max(p.volume_drift, std::abs(mesh_volume(mesh) / mesh_volume(type.reference) - 1));
      p.area_drift = std::max(p.area_drift, std::abs(mesh_area(mesh) / mesh_area(type.reference) - 1));
    }
  p.overlap = check_overlap(geometry);
  return p;
}

std::string red_cells(double phi, int seed) {
  return "[box]\nsize = [5, 5, 5]\n[flow]\ncapillary_number = 0.05\n[accuracy]\nradius = 6\nshell_thickness = 0.3\n[run]\nseed = " + std::to_string(seed) + "\n[[cells]]\neffective_volume_fraction = " + std::to_string(phi) +
         "\n";
}

}  // namespace

TEST_CASE("Red cells pack to an effective volume fraction of 0.2 and 0.45 without deformation to speak of", "[packing]") {
  for (const double phi : {0.2, 0.45}) {
    const auto p = pack(red_cells(phi, 1));
    CHECK(p.overlap.is_clean());
    CHECK(p.overlap.smallest_gap > 0.5);
    CHECK(p.volume_drift < 0.01);
    CHECK(p.area_drift < 0.05);
  }
}

TEST_CASE("Red cells pack to an effective volume fraction of 0.9", "[packing]") {
  const auto p = pack(red_cells(0.9, 1));
  CHECK(p.phi_effective == Approx(0.9).margin(0.01));
  CHECK(p.overlap.is_clean());
  CHECK(p.overlap.smallest_gap > 0.3);  // the repulsion's range is 1; at 0.1 its force stops growing
  CHECK(p.volume_drift < 0.02);
  CHECK(p.area_drift < 0.08);
}

TEST_CASE("A packing follows from its seed", "[packing]") {
  const auto a = pack(red_cells(0.3, 7)), b = pack(red_cells(0.3, 7)), c = pack(red_cells(0.3, 8));
  CHECK(a.positions == b.positions);
  CHECK(a.positions != c.positions);
}

TEST_CASE("Mixtures of sizes and shapes pack in a periodic box", "[packing]") {
  const auto p = pack("[box]\nsize = [5, 5, 5]\nwalls = false\n[flow]\nkind = 'rest'\n[accuracy]\nradius = 5\n[run]\nsteps = 1\n[[cells]]\nvolume_fraction = 0.2\n[[cells]]\nshape = 'sphere'\nrelative_radius = 0.5\n"
                      "volume_fraction = 0.1\n[[cells]]\nshape = 'spheroid'\naspect_ratio = 2.0\nrelative_radius = 0.8\nvolume_fraction = 0.1\n");
  CHECK(p.types.size() == 3);
  CHECK(p.overlap.is_clean());
  CHECK(p.volume_drift < 0.02);
}

TEST_CASE("Cells put on top of each other are refused", "[packing]") {
  const std::string two = "[box]\nsize = [5, 5, 5]\n[flow]\ncapillary_number = 0.05\n[accuracy]\nradius = 5\n[[cells]]\ncount = 1\nposition = [2.5, 2.5, 2.5]\n[[cells]]\ncount = 1\nposition = [2.5, 2.5, ";
  CHECK(pack(two + "3.5]\n").overlap.is_clean());
  CHECK_THROWS_AS(pack(two + "2.7]\n"), InputError);
}
