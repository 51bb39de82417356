// Scenes at the ends of what the program is for. Each must run without a guard stopping it, and keep what physics says it keeps.
#include <Eigen/Geometry>
#include <cmath>

#include "io/scene.hpp"
#include "physics/mesh.hpp"
#include "physics/packing.hpp"
#include "physics/suspension.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

namespace {

struct Extreme {
  Problem problem;
  LatticeParameters lattice;
  std::vector<CellType> types;
  std::unique_ptr<Suspension> suspension;

  explicit Extreme(const std::string& scene) : problem(parse_scene(scene, "extreme.toml")), lattice(to_lattice(problem)), types(make_cell_types(problem, lattice)) {
    suspension = make_suspension(problem, lattice, types, place_cells(problem, lattice, types));
    if (packs_cells(problem, types)) suspension->settle();
  }

  /// Steps under guard; the sample of the last one.
  Sample run(std::int64_t steps) {
    for (std::int64_t i = 1; i < steps; ++i) {
      suspension->step();
      if (i % 100 == 0) suspension->check();
    }
    const Sample sample = suspension->step_and_measure();
    suspension->check();
    return sample;
  }
  Sample run_strain(double strain) { return run(std::llround(strain * lattice.steps_per_strain)); }

  bool cells_overlap() const { return !overlap_of(problem, lattice, types, suspension->snapshot(false).positions).is_clean(); }

  /// Sharpest fold between two triangles of any cell, as the cosine of the angle between their normals: -1 where one lies on the other, turned over.
  double sharpest_fold() const {
    const auto x = suspension->snapshot(false).positions;
    double sharpest = 1;
    for (const auto& type : types) {
      const auto edges = mesh_edges(type.reference);
      for (int c = 0; c < type.count; ++c) {
        const auto at = [&](int v) {
          const std::size_t i = 3 * (std::size_t(type.first_vertex) + std::size_t(c) * type.vertices() + v);
          return Vector3(x[i], x[i + 1], x[i + 2]);
        };
        for (const auto& e : edges) sharpest = std::min(sharpest, std::cos(edge_angle(at(e.p), at(e.q), at(e.left), at(e.right))));
      }
    }
    return sharpest;
  }
};

std::string suspension_of_12(const std::string& flow, const std::string& accuracy) {
  return "[box]\nsize = [4, 4, 4]\n[[cells]]\ncount = 12\n[flow]\n" + flow + "[accuracy]\nradius = 5\n" + accuracy;
}

}  // namespace

TEST_CASE("phi_eff = 0.90 packs, starts and is sheared by two strain units", "[extremes]") {
  Extreme scene("[box]\nsize = [5, 5, 6]\n[flow]\ncapillary_number = 0.081\n[[cells]]\neffective_volume_fraction = 0.9\n[accuracy]\nradius = 6\nshell_thickness = 0.3\n[run]\nstrain = 2\n");
  CHECK(scene.lattice.phi_effective == Approx(0.9).epsilon(0.02));
  const Sample sample = scene.run_strain(2);
  CHECK(sample.volume_drift_max < 0.03);  // the model's own bound on drift: 1-3 %
  CHECK(sample.relative_viscosity > 2);
  CHECK_FALSE(scene.cells_overlap());
}

TEST_CASE("Ca = 4.2e-5 with kappa_S = 0.2: the paper's stiffest cells", "[extremes]") {
  for (const char* update : {"averaged", "chebyshev"}) {
    INFO(update);
    Extreme scene(suspension_of_12("capillary_number = 4.2e-5\n", "shear_modulus = 0.2\nvertex_update = '" + std::string(update) + "'\n"));
    CHECK(scene.lattice.steps_per_strain == Approx(5 / (1.2 * 4.2e-5)).epsilon(1e-6));
    const Sample sample = scene.run(3000);
    CHECK(sample.volume_drift_max < 0.01);
    CHECK(sample.area_drift_max < 0.01);
    CHECK_FALSE(scene.cells_overlap());
  }
}

TEST_CASE("Forty times stiffer than the paper's stiffest run: chebyshev steps at Ca = 4.2e-5", "[extremes]") {
  // kappa_S = 48 eta_0: as many steps per strain unit as the paper's softest cells need. The momentum balance holds as for soft cells: what the cells carry arrives at the walls.
  Extreme scene(suspension_of_12("capillary_number = 4.2e-5\nreynolds_number_max = 0.2\n", "shear_modulus = 8\nvertex_update = 'chebyshev'\nallow_unstable = true\n"));
  CHECK(scene.lattice.steps_per_strain < 3200);
  scene.run_strain(0.3);
  double particles = 0, walls = 0;
  for (int i = 0; i < 60; ++i) {
    const Sample sample = scene.run(10);
    particles += sample.relative_viscosity / 60;
    walls += sample.wall_relative_viscosity / 60;
    CHECK(sample.volume_drift_max < 0.01);
    CHECK(sample.area_drift_max < 0.01);
  }
  // The fluid carries the difference; it changes by less than the excess does over its memory H^2/(pi^2 nu) = 240 steps, a twelfth of a strain unit.
  CHECK(walls == Approx(particles).epsilon(0.05));
  CHECK_FALSE(scene.cells_overlap());
}

TEST_CASE("Ca = 5: a cell is drawn out without turning a triangle over", "[extremes]") {
  Extreme scene("[box]\nsize = [12, 4, 6]\n[flow]\ncapillary_number = 5\n[[cells]]\ncount = 1\n[accuracy]\nradius = 5\n[run]\nstrain = 6\n");
  const Sample sample = scene.run_strain(6);
  INFO("D = " << sample.mean_deformation << ", area drift " << sample.area_drift_max);
  CHECK(sample.volume_drift_max < 0.01);
  CHECK(scene.sharpest_fold() > -0.9);
}

TEST_CASE("Relaxation times 0.51 and 3", "[extremes]") {
  for (const double tau : {0.51, 3.0}) {
    INFO("tau = " << tau);
    Extreme scene(suspension_of_12("capillary_number = 0.05\n", "collision = 'trt'\nrelaxation_time = " + std::to_string(tau) + "\n"));
    const Sample sample = scene.run(std::min<std::int64_t>(3000, std::llround(scene.lattice.steps_per_strain)));
    CHECK(sample.volume_drift_max < 0.03);  // tau = 3 gives Ma = 0.06 and soft volumes (kappa_V doesn't grow with the viscosity)
    CHECK(std::isfinite(sample.relative_viscosity));
    CHECK_FALSE(scene.cells_overlap());
  }
}

TEST_CASE("A shear rate of 5.6e-7 survives single precision", "[extremes]") {
  // The walls move 5.6e-6 a step. Populations are stored without their weights, so rounding is relative to such velocities: 6e-8 of them a step and node, of either sign, which the
  // viscous fluid forgets within H^2/(pi^2 nu) = 240 steps: sqrt(240) 6e-8 = 1e-6 of the motion; a thousandth leaves room for contacts, which amplify differences.
  const auto moved = [](const char* precision, Sample& sample) {
    Extreme scene(suspension_of_12("capillary_number = 0.0028\n", "shear_rate = 5.6e-7\nprecision = '" + std::string(precision) + "'\n"));
    const auto start = scene.suspension->snapshot(false).positions;
    sample = scene.run(4000);
    auto x = scene.suspension->snapshot(false).positions;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] -= start[i];
    return x;
  };
  Sample in_single, in_double;
  const auto a = moved("single", in_single), b = moved("double", in_double);
  double difference = 0, motion = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference = std::max(difference, std::abs(a[i] - b[i]));
    motion = std::max(motion, std::abs(b[i]));
  }
  INFO("difference " << difference << " of " << motion << "; viscosity " << in_single.relative_viscosity << " against " << in_double.relative_viscosity);
  CHECK(motion > 0.005);
  CHECK(difference < 1e-3 * motion);
  CHECK(in_single.relative_viscosity == Approx(in_double.relative_viscosity).epsilon(1e-3));
}

TEST_CASE("A million steps at rest: nothing moves, no mass is lost", "[extremes][slow]") {
  Extreme scene("[box]\nsize = [4, 4, 4]\nwalls = false\n[flow]\nkind = 'rest'\n[[cells]]\ncount = 1\n[accuracy]\nradius = 3\nprecision = 'double'\n[run]\nsteps = 1000000\n");
  const auto start = scene.suspension->snapshot(false).positions;
  const Sample sample = scene.run(1000000);
  const auto x = scene.suspension->snapshot(false).positions;
  double moved = 0;
  for (std::size_t i = 0; i < x.size(); ++i) moved = std::max(moved, std::abs(x[i] - start[i]));
  INFO("moved " << moved << ", speed " << sample.velocity_max << ", volume drift " << sample.volume_drift_max);
  // Forces of the reference shape are zero to rounding, 1e-16 times the moduli; a biased rounding of 1e-16 a step would add up to 1e-10.
  CHECK(moved < 1e-9);
  CHECK(sample.velocity_max < 1e-12);
  for (const double momentum : scene.suspension->fluid_momentum()) CHECK(std::abs(momentum) < 1e-9);
}

TEST_CASE("Two cells that start in contact move apart without piercing each other", "[extremes]") {
  // Rims 0.2 lattice units apart: the repulsion there is 24 kappa_S.
  const std::string cell = "[[cells]]\nshape = 'sphere'\ncount = 1\nmembrane = { law = 'neo_hookean', bending = 0.001 }\n";
  Extreme scene("[box]\nsize = [6, 4, 4]\nwalls = false\n[flow]\nkind = 'rest'\n" + cell + "position = [1.5, 2, 2]\n" + cell + "position = [3.54, 2, 2]\n[accuracy]\nradius = 5\n[run]\nsteps = 1000\n");
  const auto smallest_gap = [&] {
    const auto x = scene.suspension->snapshot(false).positions;
    const std::size_t n = x.size() / 2;
    double least = 1e300;
    for (std::size_t a = 0; a < n; a += 3)
      for (std::size_t b = n; b < 2 * n; b += 3)
        least = std::min(least, std::hypot(x[a] - x[b], x[a + 1] - x[b + 1], x[a + 2] - x[b + 2]));
    return least;
  };
  CHECK(smallest_gap() < 0.3);
  const Sample end = scene.run(3000);
  CHECK(smallest_gap() > 0.9);  // the range of the repulsion is 1; vertices slide into the gaps of the other mesh
  CHECK(0.5 * (end.cells[0].centre[0] + end.cells[1].centre[0]) == Approx(2.52 * 5).margin(0.01));  // equal and opposite
  CHECK_FALSE(scene.cells_overlap());
}

TEST_CASE("A cell squeezed at a wall is pushed off it and stays inside", "[extremes]") {
  // 0.05 lattice units from the wall. kappa_S, and with it the contact, grows as (tau - 1/2)^2 at a given Re: from tau = 1.5 on the first step compresses the fluid beyond its guard.
  Extreme scene("[box]\nsize = [4, 4, 4]\n[flow]\ncapillary_number = 0.05\n[[cells]]\nshape = 'sphere'\ncount = 1\nposition = [2, 2, 1.01]\n[accuracy]\nradius = 5\nrelaxation_time = 1.0\n[run]\nstrain = 3\n");
  const Sample end = scene.run_strain(3);
  const auto x = scene.suspension->snapshot(false).positions;
  double lowest = 100;
  for (std::size_t i = 2; i < x.size(); i += 3) lowest = std::min(lowest, x[i]);
  CHECK(lowest > 0.3);
  CHECK(end.cells[0].centre[2] > 5.05);  // soft particles leave walls
  CHECK(end.volume_drift_max < 0.01);
}

TEST_CASE("One cell fills its periodic box and touches its own images", "[extremes]") {
  Extreme scene("[box]\nsize = [2.1, 2.1, 2.4]\n[flow]\ncapillary_number = 0.05\n[[cells]]\nshape = 'sphere'\ncount = 1\n[accuracy]\nradius = 5\n[run]\nstrain = 3\n");
  const Sample end = scene.run_strain(3);
  CHECK(end.volume_drift_max < 0.01);
  CHECK(end.relative_viscosity > 1);
  CHECK_FALSE(scene.cells_overlap());
}

TEST_CASE("Sizes from 0.4 to 1.2, stiffness from 0.2 to 5, three shapes and two laws in one box", "[extremes]") {
  Extreme scene(
      "[box]\nsize = [6, 5, 6]\n[flow]\ncapillary_number = 0.05\n"
      "[[cells]]\ncount = 8\n[[cells]]\nname = 'large'\ncount = 3\nrelative_radius = 1.2\nrelative_stiffness = 0.2\n"
      "[[cells]]\nshape = 'sphere'\ncount = 10\nrelative_radius = 0.5\nrelative_stiffness = 5\nmembrane = { law = 'neo_hookean' }\n"
      "[[cells]]\nshape = 'spheroid'\naspect_ratio = 2\ncount = 6\nrelative_radius = 0.8\n[accuracy]\nradius = 5\n[run]\nstrain = 1\n");
  const Sample end = scene.run_strain(1);
  CHECK(end.cells.size() == 27);
  CHECK(end.volume_drift_max < 0.02);
  CHECK_FALSE(scene.cells_overlap());
}
