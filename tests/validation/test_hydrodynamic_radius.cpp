// The default shell of each kernel is the one that the drag of a rigid sphere shows, and the periodic box is accounted for.
#include "physics/hydrodynamic_size.hpp"
#include "tests/catch.hpp"
#include "tests/validation/rigid_sphere.hpp"

using namespace corpuscle;
using namespace corpuscle::rigid_sphere;

namespace {

Setup sphere(int points, int radius, int box) {
  Setup s;
  s.delta_kernel = points;
  s.radius = radius;
  s.subdivision = radius;
  s.box = box;
  return s;
}

double shell_of(const Setup& s) { return measure(s).hydrodynamic_radius - s.radius; }

}  // namespace

TEST_CASE("Hasimoto's drag of a rigid sphere gives the default shell of each kernel", "[hydrodynamic_radius]") {
  // Scatter over the place of the sphere on the lattice: standard deviation 0.008 (2 points), 0.002 (3 and 4); the line plane + curvature/a misses the means by 0.007 at most; the
  // mean of two places and the tolerance of the steady state, 2e-4, fit into 0.02.
  // BGK at tau = 1 and 1.5: the common dependence on Lambda misses the single kernels by up to 0.02 more.
  const struct { int radius; CollisionKind collision; double tau, margin; } cases[] = {
      {4, CollisionKind::trt, 2, 0.02}, {6, CollisionKind::trt, 2, 0.02}, {4, CollisionKind::bgk, 1, 0.03}, {4, CollisionKind::bgk, 1.5, 0.04}};
  for (const int points : {2, 3, 4})
    for (const auto& c : cases) {
      Setup s = sphere(points, c.radius, 6 * c.radius);
      s.collision = c.collision;
      s.relaxation_time = c.tau;
      double mean = 0;
      for (s.place = 0; s.place < 2; ++s.place) mean += shell_of(s) / 2;
      AccuracySpec accuracy;
      accuracy.delta_kernel = points;
      accuracy.collision = c.collision;
      accuracy.relaxation_time = c.tau;
      INFO(points << " points, radius " << c.radius << ", tau " << c.tau << ": shell " << mean);
      CHECK(mean == Approx(shell_thickness(accuracy, c.radius)).margin(c.margin));
    }
}

TEST_CASE("The drag follows Hasimoto's dependence on the size of the box", "[hydrodynamic_radius]") {
  // a/L = 1/5 and 1/10 change the drag by 2.13/1.39; the series is cut off after (a/L)^6, an error below 1e-3 of the drag at 1/5, that is 0.003 of a = 4 (d ln K/d ln a adds to 1),
  // and as much for the steady state and the rounding of the place: 0.01.
  for (const int points : {2, 3, 4}) {
    INFO(points << " points");
    CHECK(shell_of(sphere(points, 4, 20)) == Approx(shell_of(sphere(points, 4, 40))).margin(0.01));
  }
}

TEST_CASE("A uniform force moves a stiff capsule like a rigid sphere", "[hydrodynamic_radius]") {
  // The traction of a translating sphere is uniform, so a capsule keeps its shape and its shell but for the kernel's unevenness, which an elastic membrane balances: 0.01 covers the
  // finite stiffness (velocities differ by 0.3 % over the capsule).
  for (const int points : {2, 3, 4}) {
    Setup s = sphere(points, 4, 24);
    const double rigid = shell_of(s);
    s.hold = Hold::elastic;
    INFO(points << " points");
    CHECK(shell_of(s) == Approx(rigid).margin(0.01));
  }
}

TEST_CASE("Drag, torque and stresslet agree on the shell of a plane", "[hydrodynamic_radius]") {
  // To first order in the kernel's width every no-slip surface moves outwards by the same distance: half the mean distance between two points displaced by the kernel,
  // projected on the normal (0.232, 0.310, 0.411 in the continuum). What depends on the flow goes as 1/a: two radii give the limit. The lattice adds 0.01 to 0.06 (measured:
  // at distances of one node its flow is not that of the continuum); extrapolation triples the scatter over the places, 0.002 (3, 4 points),
  // and leaves the next order, width^3/a^2 = 0.72^3/(4 * 8) = 0.012 times a number of order one, of either sign: 0.04 between two flows.
  for (const int points : {3, 4}) {
    const double continuum = points == 3 ? 0.310 : 0.411;
    double low = 1, high = 0;
    for (const Motion motion : {Motion::translation, Motion::rotation, Motion::strain_shear}) {
      Setup small = sphere(points, 4, 24), large = sphere(points, 8, 48);
      small.motion = large.motion = motion;
      const double plane = 2 * shell_of(large) - shell_of(small);
      low = std::min(low, plane);
      high = std::max(high, plane);
    }
    INFO(points << " points: " << low << " ... " << high);
    CHECK(high - low < 0.04);
    CHECK(low > continuum);
    CHECK(high < continuum + 0.07);
  }
}
