// Contact patches and stretching forces: symmetric, without net force, as large as the scene says.
#include "physics/stretching.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "core/error.hpp"
#include "io/scene.hpp"
#include "physics/contact_patches.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

namespace {

const std::string scene =
    "[box]\nsize = [6, 6, 6]\nwalls = false\n[flow]\nkind = 'rest'\n[accuracy]\nradius = 8\nshear_modulus = 0.02\n[run]\nsteps = 10\n"
    "[[cells]]\nname = 'still'\ncount = 1\nposition = [1.5, 1.5, 1.5]\n"
    "[[cells]]\nname = 'pulled'\nrelative_radius = 0.8\nrelative_stiffness = 1.5\ncount = 1\nposition = [4, 4, 4]\n";

struct Result {
  std::vector<CellType> types;
  std::vector<Vector3> forces;
  LatticeParameters lattice;
};

Result forces_of(const std::string& text) {
  const Problem problem = parse_scene(text, "test.toml");
  Result r;
  r.lattice = to_lattice(problem);
  r.types = make_cell_types(problem, r.lattice);
  const int vertices = r.types.back().first_vertex + r.types.back().count * r.types.back().vertices();
  const VertexVectors forces("forces", vertices);
  REQUIRE(Stretching::needed(problem));
  const Stretching stretching(problem, r.lattice, r.types);
  stretching.add_forces(forces);
  stretching.add_forces(forces);  // adds, does not overwrite
  const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, forces);
  for (int v = 0; v < vertices; ++v) r.forces.emplace_back(host(v, 0) / 2, host(v, 1) / 2, host(v, 2) / 2);
  return r;
}

}  // namespace

TEST_CASE("The contact patches of a red cell pulled in its plane mirror each other and have the size asked for", "[stretching]") {
  for (const int n : {6, 8, 12}) {
    const double radius = n, diameter = 0.51 * radius;
    const Mesh mesh = red_cell_mesh(radius, n);
    const ContactPatches patches = contact_patches(mesh, {1, 0, 0}, diameter);
    INFO("frequency " << n);
    REQUIRE(patches.ahead.size() == patches.behind.size());
    CHECK(patches.ahead.size() >= 3);
    Vector3 ahead = Vector3::Zero(), behind = Vector3::Zero();
    for (const int v : patches.ahead) ahead += mesh.vertices[v] / double(patches.ahead.size());
    for (const int v : patches.behind) behind += mesh.vertices[v] / double(patches.behind.size());
    CHECK((ahead + behind).norm() < 1e-12 * radius);
    CHECK(std::abs(ahead.y()) < 1e-12 * radius);
    CHECK(std::abs(ahead.z()) < 1e-12 * radius);
    for (const int v : patches.ahead) CHECK((mesh.vertices[v] - Vector3(radius, 0, 0)).norm() < 1.02 * diameter / 2 + 0.02 * radius);
    // The line leaves the mesh through the middle of an edge on the rim: the chord lies inside the circle by (edge/r)^2/8.
    CHECK(patches.largest_diameter == Approx(2 * radius).epsilon(0.01));
    const Vector3 oblique(1, 0.1, 0.02);  // along x there may be a vertex on the line
    const double smallest = contact_patches(mesh, oblique, diameter).smallest_diameter;
    CHECK(contact_patches(mesh, oblique, 0.999 * smallest).ahead.empty());
    CHECK_FALSE(contact_patches(mesh, oblique, 1.001 * smallest).ahead.empty());
  }
}

TEST_CASE("Along its axis a red cell is held at its dimples", "[stretching]") {
  const Mesh mesh = red_cell_mesh(8, 8);
  const ContactPatches patches = contact_patches(mesh, {0, 0, -3}, 0.18 * 8);
  REQUIRE_FALSE(patches.ahead.empty());
  for (const int v : patches.ahead) CHECK(mesh.vertices[v].z() < 0);
  CHECK(patches.largest_diameter == Approx(2 * 0.1035 * 8).epsilon(0.03));  // the thickness in the centre
}

TEST_CASE("Stretching forces: F on one patch, -F on the other, in equal shares, on the cells that have them", "[stretching]") {
  const Result r = forces_of(scene + "stretch = { force = 0.7, patch_diameter = 0.6, direction = [1, 2, 0] }\n");
  const CellType& pulled = r.types[1];
  const double force = 0.7 * (0.02 * 1.5) * (8 * 0.8);  // kappa_S of the type times its radius
  CHECK(r.lattice.cells[1].stretching_force == Approx(force).epsilon(1e-14));
  CHECK(r.lattice.cells[0].stretching_force == 0);
  const Vector3 along = Vector3(1, 2, 0).normalized();
  Vector3 total = Vector3::Zero(), ahead = Vector3::Zero();
  double largest = 0, smallest = 1e300;
  for (int v = 0; v < pulled.first_vertex; ++v) CHECK(r.forces[v].norm() == 0);
  for (int v = 0; v < pulled.vertices(); ++v) {
    const Vector3& f = r.forces[pulled.first_vertex + v];
    total += f;
    if (f.dot(along) > 0) ahead += f;
    if (f.norm() == 0) continue;
    CHECK(f.cross(along).norm() < 1e-15);
    CHECK(f.dot(along) * pulled.reference.vertices[v].dot(along) > 0);  // outwards at both ends
    largest = std::max(largest, f.norm());
    smallest = std::min(smallest, f.norm());
  }
  CHECK((ahead - force * along).norm() < 1e-14);
  CHECK(total.norm() < 1e-14);
  CHECK(largest == Approx(smallest).epsilon(1e-14));
}

TEST_CASE("The direction of a stretching force is that of the laboratory, also for a cell with another axis", "[stretching]") {
  const Result r = forces_of(scene + "axis = [1, 0, 0]\nstretch = { force = 1, direction = [0, 0, 2] }\n");
  const CellType& pulled = r.types[1];
  // The rotation that takes z to x takes -x to z: the laboratory's z points to the reference shape's -x, on its rim.
  for (int v = 0; v < pulled.vertices(); ++v) {
    const Vector3& f = r.forces[pulled.first_vertex + v];
    if (f.norm() == 0) continue;
    CHECK(std::abs(f.x()) + std::abs(f.y()) < 1e-15);
    CHECK(f.z() * -pulled.reference.vertices[v].x() > 0.5 * f.norm() * pulled.radius);
  }
}

TEST_CASE("Impossible contact patches are refused with the diameter that is possible", "[stretching]") {
  const auto message = [](const std::string& stretch) -> std::string {
    try {
      to_lattice(parse_scene(scene + "stretch = { " + stretch + " }\n", "test.toml"));
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  // Straight along x there is a vertex.
  CHECK(message("force = 1, direction = [1, 0.1, 0], patch_diameter = 0.001").find("cells.1.stretch.patch_diameter = 0.001 is too small for the mesh") == 0);
  CHECK(message("force = 1, patch_diameter = 2.5").find("cells.1.stretch.patch_diameter = 2.5 makes both patches overlap: it must be < 2") == 0);
  CHECK(message("force = 1, direction = [0, 0, 0]").find("cells.1.stretch.direction = [0, 0, 0] has no direction") != std::string::npos);
  CHECK(message("patch_diameter = 0.5").find("cells.1.stretch.patch_diameter = 0.5 has no effect here, it needs stretch.force") != std::string::npos);
  CHECK(message("force = -1").find("cells.1.stretch.force = -1 is out of range") != std::string::npos);
}
