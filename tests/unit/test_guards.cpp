// Every guard, provoked by its fault in an otherwise healthy state.
#include "physics/guards.hpp"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <limits>
#include <memory>

#include "core/error.hpp"
#include "core/random.hpp"
#include "io/scene.hpp"
#include "physics/overlap_inside.hpp"
#include "physics/packing.hpp"
#include "physics/suspension.hpp"
#include "tests/catch.hpp"
#include "tests/contains.hpp"

using namespace corpuscle;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Two spheres of radius 5 between walls, 0.8 lattice units apart.
std::string two_spheres(const std::string& guards = "") {
  return "[box]\nsize = [8, 4, 4]\n[flow]\ncapillary_number = 0.05\n[accuracy]\nradius = 5\nsubdivision = 5\n"
         "[[cells]]\nname = 'left'\nshape = 'sphere'\ncount = 1\nposition = [2, 2, 2]\n[[cells]]\nname = 'right'\nshape = 'sphere'\ncount = 1\nposition = [4.16, 2, 2]\n"
         "[run]\nstrain = 1\n[guards]\n" + guards;
}

struct Guarded {
  Problem problem;
  LatticeParameters lattice;
  Fluid<float> fluid;
  PeriodicBox box;
  std::unique_ptr<Cells> cells;
  std::unique_ptr<Contact> contact;
  std::unique_ptr<Guards> guards;

  explicit Guarded(const std::string& scene, double shift_of_right = 0)
      : problem(parse_scene(scene, "guards.toml")), lattice(to_lattice(problem)), fluid(fluid_parameters(problem, lattice)), box(fluid.grid(), problem.box.walls) {
    const auto types = make_cell_types(problem, lattice);
    auto x = place_cells(problem, lattice, types);
    for (std::size_t i = 3 * std::size_t(types[0].vertices()); i < x.size(); i += 3) x[i] += shift_of_right;
    cells = std::make_unique<Cells>(types, x);
    contact = std::make_unique<Contact>(box, ContactParameters{lattice.contact_strength, lattice.contact_range}, cells->cell_of_vertex());
    guards = std::make_unique<Guards>(problem, lattice, box, cells.get());
    fluid.initialise();
    contact->add_forces(cells->positions(), cells->forces());
  }

  /// body(view on the host)
  template <class View, class Body>
  static void edit(const View& view, const Body& body) {
    const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, view);
    body(host);
    Kokkos::deep_copy(view, host);
  }
  const Mesh& mesh() const { return cells->types()[1].reference; }
  int right(int vertex) const { return cells->types()[1].first_vertex + vertex; }
  /// Moves every vertex of the right cell, relative to its centre.
  template <class Map>
  void deform_right(const Map& map) {
    const double centre[3] = {4.16 * 5, 10, 10};
    edit(cells->positions(), [&](const auto& x) {
      for (int v = right(0); v < cells->vertex_count(); ++v) {
        double d[3];
        for (int k = 0; k < 3; ++k) d[k] = x(v, k) - centre[k];
        map(d);
        for (int k = 0; k < 3; ++k) x(v, k) = centre[k] + d[k];
      }
    });
  }

  /// What the guards say; empty when all is well.
  std::string message(bool with_cells = true) {
    try {
      guards->check(fluid, with_cells ? cells.get() : nullptr, contact.get());
    } catch (const SimulationError& error) {
      return error.what();
    }
    return "";
  }
};

void check_names(const std::string& message, const std::string& guard, const std::string& what, const std::string& key) {
  INFO(message);
  CHECK(message.starts_with("The guard on " + guard + " stopped the run before step "));
  CHECK_THAT(message, Contains(what));
  CHECK_THAT(message, Contains(key));
}

}  // namespace

TEST_CASE("Guards let a healthy suspension pass", "[guards]") {
  Guarded g(two_spheres());
  CHECK(g.message() == "");
  CHECK(g.message() == "");
}

TEST_CASE("Guards find what is not a number in positions, velocities and forces, and say where the cell was", "[guards]") {
  for (const int field : {0, 1, 2}) {
    Guarded g(two_spheres());
    Guarded::edit(field == 0 ? g.cells->positions() : field == 1 ? g.cells->velocities() : g.cells->forces(), [&](const auto& view) { view(g.right(3), 1) = not_a_number; });
    check_names(g.message(), "numbers", "cell 1 (right), last seen near (4.16, 2.00, 2.00) cell radii, has a vertex (3)", "accuracy.shear_modulus");
  }
  Guarded g(two_spheres());
  Guarded::edit(g.cells->forces(), [&](const auto& view) { view(0, 1) = std::numeric_limits<double>::infinity(); });
  check_names(g.message(), "numbers", "cell 0 (left)", "contact.strength");
}

TEST_CASE("Guards find a vertex that is too fast", "[guards]") {
  Guarded g(two_spheres());
  Guarded::edit(g.cells->velocities(), [&](const auto& u) { u(g.right(7), 2) = -0.31; });
  check_names(g.message(), "speed", "a vertex of cell 1 (right) near (", "moves at 0.31 lattice units a step, the limit is 0.3 (guards.speed)");
  Guarded slow(two_spheres("speed = 0.4\n"));
  Guarded::edit(slow.cells->velocities(), [&](const auto& u) { u(slow.right(7), 2) = -0.31; });
  CHECK(slow.message() == "");
}

TEST_CASE("Guards find a vertex beyond a wall", "[guards]") {
  for (const double z : {-0.01, 20.01}) {
    Guarded g(two_spheres());
    Guarded::edit(g.cells->positions(), [&](const auto& x) { x(g.right(0), 2) = z; });
    check_names(g.message(), "walls", "a vertex of cell 1 (right) near (", "is 0.01 lattice units beyond a wall");
  }
}

TEST_CASE("Guards find a cell that is not where it was", "[guards]") {
  Guarded g(two_spheres());
  CHECK(g.message() == "");
  // No time has passed: up to a radius is let pass. Across the periodic side, where the other cell is far.
  g.deform_right([](double(&d)[3]) { d[0] += 4.9; });
  CHECK(g.message() == "");
  g.deform_right([](double(&d)[3]) { d[0] += 5.1; });
  check_names(g.message(), "identity", "cell 1 (right) is found near (6.16, 2.00, 2.00) cell radii, 1.02 cell radii from where it was", "memory");
}

TEST_CASE("Guards find a cell that has gained or lost volume", "[guards]") {
  Guarded g(two_spheres());
  g.deform_right([](double(&d)[3]) {
    for (double& component : d) component *= 0.96;
  });
  check_names(g.message(), "volume", "cell 1 (right) near (4.16, 2.00, 2.00) cell radii has 0.8847 times the volume", "guards.volume_drift");  // 0.96^3
  Guarded inside_out(two_spheres());
  inside_out.deform_right([](double(&d)[3]) { d[0] = -d[0]; });
  check_names(inside_out.message(), "volume", "has -1 times the volume", "membrane.volume");
}

TEST_CASE("Guards find a cell whose area has grown", "[guards]") {
  // A prolate spheroid of the same volume, semi-axes 2 r and r/sqrt(2): its area is (1 + a asin(e)/(b e)) b^2/2 of the sphere's, e^2 = 1 - b^2/a^2.
  Guarded g(two_spheres("area_drift = 0.1\n"));
  g.deform_right([](double(&d)[3]) { d[0] /= std::sqrt(2.0), d[1] *= 2, d[2] /= std::sqrt(2.0); });
  const double a = 2, b = std::sqrt(0.5), e = std::sqrt(1 - b * b / (a * a));
  const std::string message = g.message();
  check_names(message, "area", "cell 1 (right) near (4.16, 2.00, 2.00) cell radii has ", "the limit is a change by 0.1 (guards.area_drift)");
  // The mesh of 250 triangles and the ellipsoid differ by the square of edge / radius, 1 %; the ratio by less.
  CHECK(std::stod(message.substr(message.find("has ") + 4)) == Approx(0.5 * b * b * (1 + a * std::asin(e) / (b * e))).epsilon(0.01));
}

TEST_CASE("Guards find a triangle without area", "[guards]") {
  Guarded g(two_spheres("damaged = 0\n"));
  const auto face = g.mesh().faces[17];
  Guarded::edit(g.cells->positions(), [&](const auto& x) {
    for (int k = 0; k < 3; ++k) x(g.right(face[0]), k) = x(g.right(face[1]), k) + 1e-4 * (x(g.right(face[0]), k) - x(g.right(face[1]), k));
  });
  check_names(g.message(), "triangles", "a triangle of cell 1 (right) near (", "has shrunk to 0.0001 of its area, the limit is 0.001 (guards.collapse)");
}

TEST_CASE("Guards let a few triangles of a cell collapse, but not many", "[guards]") {
  // Two triangles lose their area at each edge that shrinks to a point.
  const std::size_t triangles = Guarded(two_spheres()).mesh().faces.size();
  const auto message_after = [&](int edges) {
    Guarded g(two_spheres(fmt::format("damaged = {}\nfold = 180\n", 7.0 / double(triangles))));
    const auto all = mesh_edges(g.mesh());
    std::set<int> used;
    Guarded::edit(g.cells->positions(), [&](const auto& x) {
      for (std::size_t i = 0, done = 0; i < all.size() && done < std::size_t(edges); ++i) {
        if (used.contains(all[i].p) || used.contains(all[i].q)) continue;
        used.insert({all[i].p, all[i].q, all[i].left, all[i].right});
        for (int k = 0; k < 3; ++k) x(g.right(all[i].p), k) = x(g.right(all[i].q), k);
        ++done;
      }
    });
    return g.message();
  };
  CHECK(message_after(3).empty());  // 6 triangles
  check_names(message_after(4), "triangles", "a triangle of cell 1 (right) near (", fmt::format("(guards.collapse); 8 of {} are beyond it", triangles));
}

TEST_CASE("Guards find a triangle that lies on its neighbour, turned over", "[guards]") {
  Guarded g(two_spheres("damaged = 0\n"));
  const MeshEdge edge = mesh_edges(g.mesh())[11];
  // One tip goes to the other side of the edge, into the plane of the other triangle.
  Guarded::edit(g.cells->positions(), [&](const auto& x) {
    for (int k = 0; k < 3; ++k) x(g.right(edge.left), k) = 0.25 * (x(g.right(edge.p), k) + x(g.right(edge.q), k)) + 0.5 * x(g.right(edge.right), k);
  });
  check_names(g.message(), "folds", "two triangles of cell 1 (right) near (", "180.0 degrees between their normals, the limit is 175 (guards.fold)");
}

TEST_CASE("Guards find a vertex inside another cell, where cells must not be", "[guards]") {
  Guarded touching(two_spheres(), -0.6);
  CHECK(touching.message() == "");
  Guarded g(two_spheres(), -1.6);
  const std::string message = g.message();
  check_names(message, "contact", "a vertex of cell 0 (left) near (2.9", "inside cell 1 (right), the limit is 0.6 (guards.penetration");
  // Spheres 9.2 apart overlap by 0.8; facets lie inside the spheres by up to edge^2/(8 r) = 0.04, each, and the deepest vertex need not lie on the axis.
  const double depth = std::stod(message.substr(message.find(" lies ") + 6));
  CHECK(depth < 0.8);
  CHECK(depth > 0.6);
  Guarded free(two_spheres(), -1.6);
  free.contact = nullptr;
  CHECK(free.message() == "");
}

TEST_CASE("The signed distance of points near a surface: that of the nearest triangle, negative where the winding number is 0", "[guards]") {
  Mesh mesh = red_cell_mesh(5, 5);
  RandomStream random(3);
  for (auto& x : mesh.vertices) x += 0.2 * Vector3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));  // concave and convex edges
  const OneRing ring = one_ring(mesh);
  const auto vec = [](const Vector3& v) { return Vec3<double>{v.x(), v.y(), v.z()}; };
  CellView view{mesh.vertices[0].data(), int(mesh.vertices.size()), &mesh.faces};
  int inside = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3 p(random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(-2, 2));
    SignedDistance distance;
    for (int v = 0; v < ring.vertex_count; ++v) {
      const Vector3& at = mesh.vertices[v];
      for (int k = 0; k < ring.degree[v]; ++k) {
        const auto neighbour = [&](int j) { return vec(mesh.vertices[ring.neighbour[v * ring.max_degree + j % ring.degree[v]]] - at); };
        distance.look_at(vec(p - at), neighbour(k), neighbour(k + 1));
      }
    }
    // No vertex is nearer than the surface, and the surface is no farther than the nearest vertex.
    double nearest = 1e300;
    for (const auto& x : mesh.vertices) nearest = std::min(nearest, (x - p).norm());
    INFO("point " << p.transpose() << ", depth " << distance.depth() << ", nearest vertex " << nearest);
    CHECK(std::abs(distance.depth()) <= nearest * (1 + 1e-9));
    const bool winds = winding_number(view, p) > 0.5;
    CHECK((distance.depth() > 0) == winds);
    DepthInSurface all;
    for (const auto& face : mesh.faces) all.look_at(vec(mesh.vertices[face[0]] - p), vec(mesh.vertices[face[1]] - p), vec(mesh.vertices[face[2]] - p));
    CHECK(all.depth() == Approx(distance.depth()).epsilon(1e-9).margin(1e-9));
    inside += winds;
  }
  CHECK(inside > 200);
}

TEST_CASE("Guards find a node of the fluid that is not a number, too fast, too dense or too thin", "[guards]") {
  const auto push = [](Guarded& g, int x, int y, int z, double along_x) {
    Guarded::edit(g.fluid.force(), [&](const auto& force) { force(g.fluid.grid().index(x, y, z), 0) = static_cast<float>(along_x); });
  };
  Guarded broken(two_spheres());
  push(broken, 7, 3, 4, not_a_number);
  broken.fluid.collide_stream();
  // What a node has collided is found at its 19 neighbours, the first of them one plane below.
  check_names(broken.message(false), "the fluid", "19 nodes are beyond a limit, the first one near (1.50, 0.50, 0.70) cell radii, where the density is not a number", "accuracy.mach_max");

  Guarded fast(two_spheres());
  push(fast, 7, 3, 4, 2.0);
  fast.fluid.collide_stream();
  check_names(fast.message(false), "the fluid", "nodes are beyond a limit, the first one near (", "(guards.speed)");

  // Two nodes pushed against each other: the density between them grows, behind them it falls.
  Guarded dense(two_spheres("density = 0.01\n"));
  push(dense, 7, 3, 4, 0.05);
  push(dense, 9, 3, 4, -0.05);
  dense.fluid.collide_stream();
  check_names(dense.message(false), "the fluid", "the limits are 1 +- 0.01 (guards.density)", "stresses of the cells compress the fluid: lower accuracy.relaxation_time");
  Guarded same(two_spheres());
  push(same, 7, 3, 4, 0.05);
  push(same, 9, 3, 4, -0.05);
  same.fluid.collide_stream();
  CHECK(same.message(false) == "");
}

TEST_CASE("Guards don't change what is computed", "[guards]") {
  const Guarded g(two_spheres());
  std::vector<double> positions[2];
  for (const bool guarded : {false, true}) {
    const auto types = make_cell_types(g.problem, g.lattice);
    const auto suspension = make_suspension(g.problem, g.lattice, types, place_cells(g.problem, g.lattice, types));
    for (int i = 0; i < 21; ++i) {
      suspension->step();
      if (guarded) suspension->check();
    }
    positions[guarded] = suspension->snapshot(false).positions;
  }
  CHECK(positions[0] == positions[1]);
}
