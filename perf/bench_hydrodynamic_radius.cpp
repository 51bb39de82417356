// Hydrodynamic shell of each delta kernel: a_h - a of a sphere of vertices (docs/theory/hydrodynamic_radius.md has the tables that this prints).
// usage: bench_hydrodynamic_radius [TABLE]   TABLE: radius (default), mesh, viscosity, box, hold
#include <fmt/format.h>

#include <Kokkos_Core.hpp>
#include <string>

#include "tests/validation/rigid_sphere.hpp"

using namespace corpuscle;
using namespace corpuscle::rigid_sphere;

namespace {

/// One row: mean shell over the places and its standard deviation, for each motion.
void row(const std::string& name, Setup s, int places, std::initializer_list<Motion> motions) {
  fmt::print("{:<44}", name);
  for (const Motion motion : motions) {
    s.motion = motion;
    double sum = 0, squares = 0;
    try {
      for (s.place = 0; s.place < places; ++s.place) {
        const double shell = measure(s).hydrodynamic_radius - s.radius;
        sum += shell;
        squares += shell * shell;
      }
    } catch (const std::runtime_error&) {  // vertices closer than the kernel resolves
      fmt::print("  {:>15}", "does not settle");
      continue;
    }
    const double mean = sum / places;
    fmt::print("  {:6.3f} +- {:5.3f}", mean, std::sqrt(std::max(0.0, squares / places - mean * mean)));
    std::fflush(stdout);
  }
  fmt::print("\n");
}

constexpr auto all = {Motion::translation, Motion::rotation, Motion::strain_diagonal, Motion::strain_shear};

}  // namespace

int main(int argc, char* argv[]) {
  const Kokkos::ScopeGuard kokkos(argc, argv);
  const std::string table = argc > 1 ? argv[1] : "radius";
  fmt::print("shell a_h - a in lattice units, mean and standard deviation over the places\n{:<44}{:>17}{:>17}{:>17}{:>17}\n", "", "translation", "rotation", "diagonal strain", "shear strain");
  for (const int points : {2, 3, 4}) {
    Setup s;
    s.delta_kernel = points;
    const auto named = [&](const std::string& what) { return fmt::format("{} points, {}", points, what); };
    if (table == "radius") {
      for (const double radius : {3.0, 4.0, 6.0, 8.0, 12.0}) {
        s.radius = radius;
        s.subdivision = int(radius);
        s.box = int(6 * radius);
        row(named(fmt::format("r = {}", radius)), s, radius > 8 ? 1 : radius > 6 ? 2 : 5, all);
      }
    } else if (table == "mesh") {
      // A membrane holds the vertices: springs on vertices closer than the kernel resolves take for ever to settle.
      s.hold = Hold::elastic;
      for (const int subdivision : {4, 5, 6, 8, 9}) {
        s.subdivision = subdivision;
        row(named(fmt::format("r = 6, stiff capsule, n/r = {:.2f}", subdivision / s.radius)), s, 3, {Motion::translation});
      }
    } else if (table == "viscosity") {
      for (const CollisionKind collision : {CollisionKind::bgk, CollisionKind::trt})
        for (const double tau : {0.7, 1.0, 1.5}) {
          s.collision = collision;
          s.relaxation_time = tau;
          s.radius = 4;
          s.subdivision = 4;
          s.box = 24;
          row(named(fmt::format("r = 4, {}, tau = {}", collision == CollisionKind::bgk ? "BGK" : "TRT", tau)), s, 3, {Motion::translation, Motion::rotation, Motion::strain_shear});
        }
    } else if (table == "box") {
      for (const int box : {24, 32, 40, 48}) {
        s.radius = 4;
        s.subdivision = 4;
        s.box = box;
        row(named(fmt::format("r = 4, L = {}", box)), s, 2, all);
      }
    } else if (table == "hold") {
      for (const Hold hold : {Hold::rigid, Hold::uniform, Hold::elastic})
        for (s.place = 0; s.place < 3; ++s.place) {
          s.hold = hold;
          const Result r = measure(s);
          fmt::print("{} points, r = 6, place {}, {}: shell {:.4f}, velocity spread {:.2g}, {} steps\n", points, s.place,
                     hold == Hold::rigid ? "rigid" : hold == Hold::uniform ? "uniform force" : "elastic", r.hydrodynamic_radius - s.radius, r.velocity_spread, r.steps);
          std::fflush(stdout);
        }
    } else {
      fmt::print(stderr, "unknown table {}: radius, mesh, viscosity, box, hold\n", table);
      return 2;
    }
  }
  return 0;
}
