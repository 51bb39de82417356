#include "core/cell_list.hpp"

#include <algorithm>
#include <numeric>

#include "core/random.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

TEST_CASE("Bins are at least as long as the edge and limited in number", "[cell_list]") {
  const double length[3] = {10, 3.1, 0.7};
  const BinGrid bins(length, 1.5);
  CHECK(bins.count[0] == 6);
  CHECK(bins.count[1] == 2);
  CHECK(bins.count[2] == 1);
  for (int k = 0; k < 3; ++k) CHECK(bins.inverse_edge[k] * length[k] == Approx(bins.count[k]));
  const double large[3] = {400, 500, 600};
  const BinGrid few(large, 1, 1000);
  CHECK(few.bins() <= 1000);
  CHECK(few.bins() > 500);
  CHECK(bins.coordinate(-0.1, 0) == 0);
  CHECK(bins.coordinate(10.1, 0) == 5);
}

TEST_CASE("Every point is in its bin once, in ascending order", "[cell_list]") {
  const int points = 5000, bins = 97;
  Array1<int> keys("keys", points);
  const auto host = Kokkos::create_mirror_view(keys);
  RandomStream random(3);
  for (int i = 0; i < points; ++i) host(i) = int(random.uniform(0, bins));
  Kokkos::deep_copy(keys, host);
  CellList list;
  list.build(keys, points, bins);
  const auto begin = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, list.begin());
  const auto order = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, list.order());
  CHECK(begin(0) == 0);
  CHECK(begin(bins) == points);
  std::vector<int> seen(points, 0);
  for (int b = 0; b < bins; ++b)
    for (int i = begin(b); i < begin(b + 1); ++i) {
      ++seen[order(i)];
      REQUIRE(host(order(i)) == b);
      if (i > begin(b)) REQUIRE(order(i) > order(i - 1));
    }
  CHECK(std::count(seen.begin(), seen.end(), 1) == points);
}
