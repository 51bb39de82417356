// The shell of a cell, its effective radius and volume, and meshes that lie a shell inside the nominal surface.
#include "physics/hydrodynamic_size.hpp"

#include <cmath>
#include <fstream>
#include <numbers>

#include "core/error.hpp"
#include "io/scene.hpp"
#include "physics/cells.hpp"
#include "physics/placement.hpp"
#include "tests/catch.hpp"
#include "tests/refusal.hpp"
#include "tests/scratch.hpp"

using namespace corpuscle;

namespace {

constexpr double pi = std::numbers::pi;

Problem scene(const std::string& cell, const std::string& accuracy) {
  return parse_scene("[box]\nsize = [10, 10, 10]\n[flow]\ncapillary_number = 0.05\n[accuracy]\n" + accuracy + "\n[[cells]]\n" + cell + "\n", "scene.toml");
}

}  // namespace

TEST_CASE("The shell is that of the kernel unless the scene gives one", "[size]") {
  AccuracySpec accuracy;
  accuracy.collision = CollisionKind::trt;
  for (const int points : {2, 3, 4}) {
    accuracy.delta_kernel = points;
    const KernelShell kernel = kernel_shell(points);
    CHECK(shell_thickness(accuracy, 8) == Approx(kernel.plane + kernel.curvature / 8));
    CHECK(shell_thickness(accuracy, 4) > shell_thickness(accuracy, 8));
    accuracy.delta_kernel = points == 4 ? 3 : 4;  // wider kernels have thicker shells
    CHECK((shell_thickness(accuracy, 8) > kernel.plane + kernel.curvature / 8) == (points != 4));
  }
  const double trt = shell_thickness(accuracy, 8);
  accuracy.relaxation_time = 3;  // steady flows with TRT do not depend on tau
  CHECK(shell_thickness(accuracy, 8) == trt);
  accuracy.collision = CollisionKind::bgk;
  accuracy.relaxation_time = 0.5 + std::sqrt(3.0 / 16);  // the same Lambda
  CHECK(shell_thickness(accuracy, 8) == Approx(trt));
  accuracy.relaxation_time = 1.5;
  CHECK(shell_thickness(accuracy, 8) < trt - 0.15);
  accuracy.shell_thickness = 0.3;
  CHECK(shell_thickness(accuracy, 4) == 0.3);
  CHECK(shell_thickness(accuracy, 40) == 0.3);
  accuracy.shell_thickness = 0;
  CHECK(shell_thickness(accuracy, 8) == 0);
}

TEST_CASE("The shell that is counted in a fraction is thicker than that of the drag, unless the scene gives it", "[size]") {
  AccuracySpec accuracy;
  for (const int points : {2, 3, 4}) {
    accuracy.delta_kernel = points;
    accuracy.counted_shell = CountedShell::viscosity;
    // By the same length whatever the radius: part of the plane's.
    const double more = counted_shell(accuracy, 4) - shell_thickness(accuracy, 4);
    CHECK(more > 0.3 * kernel_shell(points).plane);
    CHECK(more < 0.5 * kernel_shell(points).plane);
    CHECK(counted_shell(accuracy, 12) - shell_thickness(accuracy, 12) == Approx(more));
    accuracy.counted_shell = CountedShell::drag;
    CHECK(counted_shell(accuracy, 4) == shell_thickness(accuracy, 4));
  }
  accuracy.counted_shell = CountedShell::viscosity;
  accuracy.shell_thickness = 0.3;
  CHECK(counted_shell(accuracy, 4) == 0.3);

  const auto lattice = [](const std::string& more) { return to_lattice(scene("effective_volume_fraction = 0.2", "radius = 4\n" + more)); };
  const LatticeParameters usual = lattice(""), drag = lattice("counted_shell = 'drag'");
  CHECK(usual.cells[0].count < drag.cells[0].count);
  CHECK(usual.cells[0].shell_thickness == drag.cells[0].shell_thickness);
  CHECK(usual.cells[0].effective_radius == drag.cells[0].effective_radius);
  CHECK(usual.phi_effective == Approx(0.2).epsilon(0.01));
  CHECK(drag.phi_effective == Approx(0.2).epsilon(0.01));
  // What fits in is known with the shells of the drag.
  CHECK(to_lattice(scene("count = 352", "radius = 4")).phi_effective > 0.92);
  CHECK(mentions(refusal(scene("count = 400", "radius = 4")), "with the shells of the drag, which can't be packed"));
  CHECK(parse_scene(to_toml(scene("count = 1", "counted_shell = 'drag'")), "merged.toml").accuracy.counted_shell == CountedShell::drag);
  CHECK_THROWS_AS(scene("count = 1", "shell_thickness = 0.3\ncounted_shell = 'drag'"), InputError);  // one shell only
}

TEST_CASE("Radii and fractions of cells whose mesh has the nominal size", "[size]") {
  const Problem problem = scene("shape = 'sphere'\nvolume_fraction = 0.1\n[[cells]]\nshape = 'sphere'\nrelative_radius = 0.5\ncount = 3", "radius = 8\ncounted_shell = 'drag'");
  const LatticeParameters lattice = to_lattice(problem);
  double effective = 0;
  for (const auto& cell : lattice.cells) {
    CHECK(cell.mesh_radius == cell.radius);
    CHECK(cell.shell_thickness == Approx(shell_thickness(problem.accuracy, cell.radius)));
    CHECK(cell.effective_radius == Approx(cell.radius + cell.shell_thickness));
    CHECK(cell.nominal_volume == cell.volume);
    effective += double(cell.count) * cell.effective_volume / lattice.box_volume();
  }
  CHECK(lattice.phi_nominal == Approx(lattice.phi_geometric));
  CHECK(lattice.phi_effective == Approx(effective));
  // The mesh of a sphere is smaller than the sphere by its facets: 1.6 % in volume at n = 8, less in the shell.
  CHECK(lattice.cells[0].effective_volume == Approx(4 * pi / 3 * std::pow(lattice.cells[0].effective_radius, 3)).epsilon(0.02));
}

TEST_CASE("A hydrodynamic sphere has its nominal radius for the flow", "[size]") {
  for (const std::string points : {"2", "3", "4"}) {
    const Problem problem = scene("shape = 'sphere'\nvolume_fraction = 0.1", "radius = 6\ncollision = 'trt'\ncell_size = 'hydrodynamic'\ndelta_kernel = " + points);
    const LatticeParameters lattice = to_lattice(problem);
    const CellTypeLattice& cell = lattice.cells[0];
    const KernelShell kernel = kernel_shell(problem.accuracy.delta_kernel);
    CHECK(cell.radius == 6);
    CHECK(cell.effective_radius == Approx(6));
    CHECK(cell.shell_thickness == Approx(kernel.plane + kernel.curvature / cell.mesh_radius));  // that of the smaller mesh
    const Mesh mesh = make_cell_types(problem, lattice)[0].reference;
    for (const Vector3& x : mesh.vertices) CHECK(x.norm() == Approx(cell.mesh_radius));
    CHECK(mesh_volume(mesh) == Approx(cell.volume));
    // volume_fraction counts nominal volumes: the number of cells does not depend on the correction.
    const LatticeParameters plain = to_lattice(scene("shape = 'sphere'\nvolume_fraction = 0.1", "radius = 6\ncollision = 'trt'\ndelta_kernel = " + points));
    CHECK(cell.count == plain.cells[0].count);
    CHECK(lattice.phi_nominal == Approx(plain.phi_geometric));
    CHECK(lattice.phi_geometric == Approx(double(cell.count) * cell.volume / lattice.box_volume()));
    CHECK(lattice.phi_geometric < plain.phi_geometric);
    CHECK(lattice.phi_effective == Approx(lattice.phi_nominal).epsilon(0.01));  // but for the facets
    // Moduli are those of the nominal cell.
    CHECK(cell.moduli.shear == Approx(plain.cells[0].moduli.shear));
    CHECK(cell.moduli.bending == Approx(plain.cells[0].moduli.bending));
    CHECK(lattice.shear_rate == Approx(plain.shear_rate));
  }
}

TEST_CASE("Meshes of other shapes lie a shell inside the nominal surface", "[size]") {
  // The volume between parallel surfaces is Steiner's: going in and adding the shell again gives the nominal volume back. Vertex normals and facets err by (edge/radius of curvature)^2/8:
  // the tightest curvature is that of the rim of the red cell and of the tips and rims of the spheroids, r/3 to r/4, with edges of r/10 to r/20 there.
  const std::string fine = "radius = 10\nsubdivision = 24\ncell_size = 'hydrodynamic'";
  for (const std::string shape : {"shape = 'red_cell'", "shape = 'spheroid'\naspect_ratio = 0.5", "shape = 'spheroid'\naspect_ratio = 2", "shape = 'sphere'"}) {
    const Problem problem = scene(shape + "\ncount = 1", fine);
    const CellTypeLattice cell = to_lattice(problem).cells[0];
    INFO(shape);
    CHECK(cell.effective_volume == Approx(cell.nominal_volume).epsilon(0.005));
    CHECK(cell.volume < cell.nominal_volume);
    CHECK(cell.effective_radius == Approx(10));
    const Mesh mesh = make_cell_types(problem, to_lattice(problem))[0].reference;
    CHECK(bounding_radius(mesh) == Approx(cell.mesh_radius).epsilon(0.005));
  }
}

TEST_CASE("The thinnest part of a mesh", "[size]") {
  CHECK(thinnest(sphere_mesh(5, 12)) == Approx(10).epsilon(0.02));
  const double rim = thinnest(spheroid_mesh(8, 0.7, 24));  // chords near the rim are as short as twice its radius of curvature, b^2/a
  CHECK(rim > 2 * 5.6 * 5.6 / 8 * 0.98);
  CHECK(rim < 2 * 5.6);
  CHECK(thinnest(red_cell_mesh(10, 20)) == Approx(2.07).epsilon(0.02));
  const Mesh sphere = sphere_mesh(5, 8), smaller = inset(sphere, 0.5);
  for (const Vector3& x : smaller.vertices) CHECK(x.norm() == Approx(4.5).epsilon(2e-3));
}

TEST_CASE("A shell too thick for the cell is refused, with the radius that would do", "[size]") {
  const std::string corrected = "cell_size = 'hydrodynamic'\n";
  const std::string message = refusal(scene("count = 1", corrected + "radius = 5"));
  CHECK(mentions(message, "cells.0: accuracy.cell_size = \"hydrodynamic\""));
  CHECK(mentions(message, "thinnest part is 1.03"));
  const double offered = std::stod(message.substr(message.find("accuracy.radius >= ") + 19));
  CHECK(refusal(scene("count = 1", corrected + "radius = " + std::to_string(offered))) == "accepted");
  CHECK(refusal(scene("count = 1", corrected + "radius = 5\nshell_thickness = 0.3")) == "accepted");
  CHECK(refusal(scene("shape = 'sphere'\ncount = 1", corrected + "radius = 4")) == "accepted");
  // A sharp edge: the inner surface of a lens of two cones would turn over at its rim.
  const ScratchFolder folder;
  std::ofstream off(folder / "lens.off");
  constexpr int n = 12;
  off << "OFF\n" << n + 2 << " " << 2 * n << " 0\n";
  for (int i = 0; i < n; ++i) off << std::cos(2 * pi * i / n) << " " << std::sin(2 * pi * i / n) << " 0\n";
  off << "0 0 0.5\n0 0 -0.5\n";
  for (int i = 0; i < n; ++i) off << "3 " << i << " " << (i + 1) % n << " " << n << "\n3 " << (i + 1) % n << " " << i << " " << n + 1 << "\n";
  off.close();
  const std::string lens = "file = '" + (folder / "lens.off").string() + "'\ncount = 1";
  CHECK(refusal(scene(lens, "radius = 8")) == "accepted");
  CHECK(mentions(refusal(scene(lens, corrected + "radius = 8")), "hydrodynamic"));
}

TEST_CASE("cell_size is a key with two values, and a shell survives the merged scene", "[size]") {
  CHECK(scene("count = 1", "").accuracy.cell_size == CellSize::mesh);
  CHECK_FALSE(scene("count = 1", "").accuracy.shell_thickness.has_value());
  CHECK_THROWS_AS(scene("count = 1", "cell_size = 'corrected'"), InputError);
  CHECK_THROWS_AS(scene("count = 1", "shell_thickness = -0.1"), InputError);
  CHECK_THROWS_AS(scene("count = 1", "shell_thickness = 2.5"), InputError);
  CHECK_THROWS_AS(scene("count = 1", "shell_thickness = 0\ncell_size = 'hydrodynamic'"), InputError);  // nothing to take off
  CHECK_THROWS_AS(parse_scene("[box]\nsize = [4, 4, 4]\n[accuracy]\ncell_size = 'hydrodynamic'", "scene.toml"), InputError);  // no cells
  const Problem empty = parse_scene("[box]\nsize = [4, 4, 4]", "scene.toml");
  CHECK(parse_scene(to_toml(empty), "merged.toml").accuracy.cell_size == CellSize::mesh);
  const Problem again = parse_scene(to_toml(scene("count = 1", "shell_thickness = 0.25\ncell_size = 'hydrodynamic'")), "merged.toml");
  CHECK(again.accuracy.shell_thickness == 0.25);
  CHECK(again.accuracy.cell_size == CellSize::hydrodynamic);
}
