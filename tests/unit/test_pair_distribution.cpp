// g(r) and contacts of ideal gases and lattices between walls and in periodic boxes.
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "physics/statistics/pair_distribution.hpp"
#include "tests/catch.hpp"
#include "tests/unit/synthetic_series.hpp"

using namespace corpuscle::statistics;
using namespace corpuscle::test;
using Eigen::Index;

namespace {

std::vector<double> gas(int n, double x, double y, double z, Normal& random) {
  std::vector<double> centres;
  for (int i = 0; i < n; ++i) centres.insert(centres.end(), {x * random.uniform(), y * random.uniform(), z * random.uniform()});
  return centres;
}

}  // namespace

TEST_CASE("g(r) of an ideal gas is one, between walls, with layers left out, and in a periodic box", "[statistics]") {
  Normal random(1);
  PairDistribution walls({.size = {8, 9, 6}, .reach = 3.5, .bins = 14, .contact_distance = 1});
  PairDistribution bulk({.size = {8, 9, 6}, .reach = 3.5, .bins = 14, .wall_layer = 1.5});
  PairDistribution periodic({.size = {8, 9, 7.5}, .origin = {0, 0, 100}, .periodic = {true, true, true}, .reach = 3.5, .bins = 14, .contact_distance = 1});
  for (int i = 0; i < 1000; ++i) {
    const auto centres = gas(40, 8, 9, 6, random);
    walls.add(centres);
    bulk.add(centres);
    auto unwrapped = gas(40, 8, 9, 7.5, random);
    for (std::size_t k = 0; k < unwrapped.size(); ++k) unwrapped[k] += k % 3 == 0 ? 16 : k % 3 == 1 ? -9 : 15;
    periodic.add(unwrapped);
  }
  for (const auto* distribution : {&walls, &bulk, &periodic}) {
    const Curve g = with_errors(distribution->result());
    CHECK(g.converged);
    CHECK(g.x[0] == Approx(0.125));
    double chi2 = 0;
    for (Index i = 0; i < g.x.size(); ++i) chi2 += std::pow((g.value[i] - 1) / g.error[i], 2);
    CHECK(chi2 < 40);  // 14 degrees: the probability of more is 2e-4, with Student's t of 32 blocks 1e-3
    CHECK(std::abs(g.value[13] - 1) < 0.03);
  }
  // Between walls a ball of radius 1 is cut: of its volume the share 1 - 2 (3/16)/6 lies within on average ((3/8) R at each wall, half of it a ball's).
  const auto contacts = walls.contact_number();
  const double ball = 4 * std::numbers::pi / 3;
  CHECK(std::abs(contacts.value - 39.0 / (8 * 9 * 6) * ball * (1 - 2 * 0.1875 / 6)) < 4 * contacts.error);
  CHECK(std::abs(periodic.contact_number().value - 39.0 / (8 * 9 * 7.5) * ball) < 4 * periodic.contact_number().error);
  CHECK(walls.contact_number().converged);
}

TEST_CASE("g(r) of a simple cubic lattice counts its shells", "[statistics]") {
  std::vector<double> centres;
  for (int i = 0; i < 216; ++i) centres.insert(centres.end(), {0.5 + i % 6, 0.5 + i / 6 % 6, 0.5 + i / 36});
  PairDistribution lattice({.size = {6, 6, 6}, .periodic = {true, true, true}, .reach = 2.2, .bins = 22, .contact_distance = 1.05});
  for (int i = 0; i < 10; ++i) lattice.add(centres);
  const auto curve = lattice.result();
  CHECK(lattice.contact_number().value == 6);
  CHECK(lattice.contact_number().error == 0);
  // Neighbours in bins: 6 at 1, 12 at sqrt 2, 8 at sqrt 3, 6 at 2.
  const Eigen::VectorXd found = curve.sums.rowwise().sum() / (10 * 216);
  CHECK(found[9] + found[10] == 6);
  CHECK(found[14] == 12);
  CHECK(found[17] == 8);
  CHECK(found[19] + found[20] == 6);
  CHECK(found.sum() == 32);

  PairDistribution slab({.size = {6, 6, 6}, .reach = 2.2, .bins = 22, .contact_distance = 1.05});
  slab.add(centres);
  CHECK(slab.contact_number().value == Approx(6 - 2.0 / 6));  // the outer layers lack one each
  CHECK(says(slab.contact_number().reason, "too few"));
  PairDistribution inside({.size = {6, 6, 6}, .reach = 2.2, .bins = 22, .wall_layer = 1, .contact_distance = 1.05});
  inside.add(centres);
  CHECK(inside.contact_number().value == Approx(6));  // neighbours in the layers count
}

TEST_CASE("g(r): long runs, and what is refused", "[statistics]") {
  Normal random(2);
  PairDistribution many({.size = {4, 4, 4}, .reach = 2, .bins = 4, .contact_distance = 1});
  for (int i = 0; i < 500; ++i) many.add(gas(5, 4, 4, 4, random));
  CHECK(many.result().blocks() == 32);
  CHECK(many.result().counts.minCoeff() > 0);
  CHECK(says(PairDistribution({.size = {4, 4, 4}, .reach = 2.1}).result().reason, "half of each periodic size"));
  CHECK(says(PairDistribution({.size = {4, 4, 4}, .reach = 1, .wall_layer = 2}).result().reason, "no bulk region"));
  CHECK(says(PairDistribution({.size = {4, 4, 0}, .reach = 1}).result().reason, "no volume"));
  CHECK(says(PairDistribution({.size = {4, 4, 4}, .reach = 1}).result().reason, "no snapshot"));
  PairDistribution lonely({.size = {4, 4, 4}, .reach = 1, .contact_distance = 1});
  lonely.add(std::vector<double>{1, 1, 1});
  CHECK(says(lonely.result().reason, "fewer than two"));
  CHECK(lonely.contact_number().value == 0);
  PairDistribution broken({.size = {4, 4, 4}, .reach = 1, .contact_distance = 1});
  broken.add(std::vector<double>(6, not_a_number));
  CHECK(says(broken.contact_number().reason, "no cell"));
}
