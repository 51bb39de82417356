// Collision of one node against the textbook's formulas, direction by direction.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "kernels/collision.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

namespace {

using Direction = std::array<double, 3>;
Direction direction(int q) { return {double(D3Q19::cx[q]), double(D3Q19::cy[q]), double(D3Q19::cz[q])}; }
double dot(const Direction& a, const Direction& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
int opposite(int q) { return q == 0 ? 0 : (q % 2 == 1 ? q + 1 : q - 1); }

struct Node {
  std::array<double, 19> f;  ///< not shifted
  Direction force;
};

Node some_node(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-1, 1);
  Node node;
  for (int q = 0; q < 19; ++q) node.f[q] = D3Q19::weight(q) * (1 + 0.1 * any(random));
  for (double& F : node.force) F = 1e-2 * any(random);
  return node;
}

/// f + Omega (f_eq - f) + source as in Guo, Zheng, Shi (2002), even and odd parts of equilibrium, populations and source relaxed with their own rates.
std::array<double, 19> textbook(const Node& node, double omega_even, double omega_odd) {
  double rho = 0;
  Direction u{};
  for (int q = 0; q < 19; ++q) {
    rho += node.f[q];
    for (int k = 0; k < 3; ++k) u[k] += direction(q)[k] * node.f[q];
  }
  for (int k = 0; k < 3; ++k) u[k] = (u[k] + 0.5 * node.force[k]) / rho;
  std::array<double, 19> equilibrium, source, out;
  for (int q = 0; q < 19; ++q) {
    const Direction c = direction(q);
    const double cu = dot(c, u), w = D3Q19::weight(q);
    equilibrium[q] = w * rho * (1 + 3 * cu + 4.5 * cu * cu - 1.5 * dot(u, u));
    source[q] = w * (3 * (dot(c, node.force) - dot(u, node.force)) + 9 * cu * dot(c, node.force));
  }
  const auto part = [](const std::array<double, 19>& a, int q, int sign) { return 0.5 * (a[q] + sign * a[opposite(q)]); };
  for (int q = 0; q < 19; ++q)
    out[q] = node.f[q] + omega_even * (part(equilibrium, q, 1) - part(node.f, q, 1)) + (1 - 0.5 * omega_even) * part(source, q, 1) +
             omega_odd * (part(equilibrium, q, -1) - part(node.f, q, -1)) + (1 - 0.5 * omega_odd) * part(source, q, -1);
  return out;
}

template <bool Forced, class Real>
std::array<double, 19> collided(const Node& node, const PairRelaxation<Real>& relaxation) {
  Real g[19], F[3];
  for (int q = 0; q < 19; ++q) g[q] = Real(node.f[q] - D3Q19::weight(q));
  for (int k = 0; k < 3; ++k) F[k] = Real(node.force[k]);
  relaxation.template collide<Forced>(g, macroscopic<Real>(g, F[0], F[1], F[2]), F[0], F[1], F[2]);
  std::array<double, 19> f;
  for (int q = 0; q < 19; ++q) f[q] = double(g[q]) + D3Q19::weight(q);
  return f;
}

double largest_difference(const std::array<double, 19>& a, const std::array<double, 19>& b) {
  double largest = 0;
  for (int q = 0; q < 19; ++q) largest = std::max(largest, std::abs(a[q] - b[q]));
  return largest;
}

}  // namespace

TEST_CASE("Collision relaxes and forces as the textbook does", "[collision]") {
  for (const double tau : {0.51, 0.6, 1.0, 2.0, 7.0})
    for (const bool trt : {false, true})
      for (unsigned seed = 1; seed < 6; ++seed) {
        CAPTURE(tau, trt, seed);
        Node node = some_node(seed);
        const auto relaxation = trt ? PairRelaxation<double>::trt(tau, 3.0 / 16) : PairRelaxation<double>::bgk(tau);
        const double omega_even = 1 / tau, omega_odd = trt ? 1 / (0.5 + 3.0 / 16 / (tau - 0.5)) : omega_even;
        CHECK(largest_difference(collided<true>(node, relaxation), textbook(node, omega_even, omega_odd)) < 1e-15);
        const auto in_single = trt ? PairRelaxation<float>::trt(tau, 3.0 / 16) : PairRelaxation<float>::bgk(tau);
        CHECK(largest_difference(collided<true>(node, in_single), textbook(node, omega_even, omega_odd)) < 1e-7);
        node.force = {};
        CHECK(largest_difference(collided<false>(node, relaxation), textbook(node, omega_even, omega_odd)) < 1e-15);
      }
}

// A rate that isn't the complement of what is kept would add up to 3e-8 of mass and momentum at each step, of one sign as far as rounding doesn't swallow it.
TEST_CASE("What collision takes from a moment and what it leaves add up in single precision", "[collision]") {
  for (int i = 0; i < 2000; ++i) {
    const double omega = 0.001 * (i + 1) * 0.99937;
    const float rate = PairRelaxation<float>::rate(omega), kept = 1.0f - rate;
    CAPTURE(omega);
    CHECK(double(kept) + double(rate) == 1.0);
    CHECK(double(rate) == Approx(omega).epsilon(0).margin(6.1e-8));
  }
}

TEST_CASE("A million collisions in single precision keep mass and momentum", "[collision]") {
  for (const double tau : {0.51, 0.6, 3.7, 9.3}) {
    CAPTURE(tau);
    const auto relaxation = PairRelaxation<float>::trt(tau, 3.0 / 16);
    const Node node = some_node(3);
    float g[19];
    for (int q = 0; q < 19; ++q) g[q] = float(node.f[q] - D3Q19::weight(q));
    const auto before = macroscopic<float>(g, 0, 0, 0);
    for (int step = 0; step < 1000000; ++step) relaxation.collide<false>(g, macroscopic<float>(g, 0, 0, 0), 0, 0, 0);
    const auto after = macroscopic<float>(g, 0, 0, 0);
    CHECK(after.density_shift == Approx(before.density_shift).epsilon(1e-3).margin(1e-6));
    for (int k = 0; k < 3; ++k) CHECK(after.u[k] == Approx(before.u[k]).epsilon(1e-3).margin(1e-6));
  }
}
