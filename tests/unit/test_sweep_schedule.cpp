// How the runs of a sweep share cores and memory.
#include "app/sweep_schedule.hpp"

#include <limits>

#include "tests/catch.hpp"

using namespace corpuscle::app;

namespace {

constexpr double gigabyte = 1e9;
std::vector<RunSize> equal(std::size_t count, double nodes) { return std::vector<RunSize>(count, {nodes, gigabyte, 10}); }
SweepMachine machine(int cores, double bytes = 1e12) { return {cores, bytes, true}; }

std::size_t at_once(const std::vector<RunSize>& runs, const SweepMachine& m, const SweepLimits& limits = {}) {
  return SweepSlots(runs, threads_of_runs(runs, m, limits), m, limits).at_once();
}

}  // namespace

TEST_CASE("sweep schedule: many small runs get a thread each, a large one all cores", "[sweep]") {
  CHECK(threads_of_runs(equal(100, 30'000), machine(16), {}) == std::vector<int>(100, 1));
  CHECK(at_once(equal(100, 30'000), machine(16)) == 16);
  CHECK(threads_of_runs(equal(100, 220'000), machine(16), {}) == std::vector<int>(100, 4));
  CHECK(at_once(equal(100, 220'000), machine(16)) == 4);
  CHECK(threads_of_runs(equal(100, 12e6), machine(16), {}) == std::vector<int>(100, 16));
  CHECK(at_once(equal(100, 12e6), machine(16)) == 1);
}

TEST_CASE("sweep schedule: cores that would be idle are used, down to a number of nodes a thread", "[sweep]") {
  CHECK(threads_of_runs(equal(4, 100'000), machine(16), {}) == std::vector<int>(4, 4));
  CHECK(threads_of_runs(equal(1, 100'000), machine(16), {}) == std::vector<int>(1, 10));
  CHECK(threads_of_runs(equal(2, 5'000), machine(16), {}) == std::vector<int>(2, 1));
  CHECK(threads_of_runs({}, machine(16), {}).empty());
}

TEST_CASE("sweep schedule: the command line decides", "[sweep]") {
  const auto runs = equal(50, 1e6);
  CHECK(threads_of_runs(runs, machine(16), {.jobs = 0, .threads = 3}) == std::vector<int>(50, 3));
  CHECK(at_once(runs, machine(16), {.jobs = 0, .threads = 3}) == 5);
  CHECK(at_once(runs, machine(16), {.jobs = 0, .threads = 32}) == 1);
  CHECK(threads_of_runs(runs, machine(16), {.jobs = 2, .threads = 0}) == std::vector<int>(50, 8));
  CHECK(at_once(runs, machine(16), {.jobs = 2, .threads = 0}) == 2);
  CHECK(at_once(runs, machine(2), {.jobs = 5, .threads = 0}) == 5);
  CHECK(at_once(runs, machine(2), {.jobs = 4, .threads = 2}) == 4);
}

TEST_CASE("sweep schedule: memory limits how many run, but one always may", "[sweep]") {
  CHECK(at_once(equal(50, 1'000), machine(16, 3.5 * gigabyte)) == 3);
  CHECK(at_once(equal(50, 1'000), machine(16, 0.5 * gigabyte)) == 1);
  // The large one begins with what fits beside it.
  std::vector<RunSize> runs = equal(3, 1'000);
  runs[0].bytes = 3 * gigabyte;
  runs[0].seconds = 100;
  const SweepMachine m = machine(16, 4 * gigabyte);
  const SweepSlots slots(runs, threads_of_runs(runs, m, {}), m, {});
  CHECK(slots.next({0, 1, 2}, {}) == 0u);
  CHECK(slots.next({1, 2}, {0}) == 1u);
  CHECK_FALSE(slots.next({2}, {0, 1}));
}

TEST_CASE("sweep schedule: a device is filled by one run", "[sweep]") {
  const SweepMachine device{16, gigabyte, false};
  const auto runs = equal(10, 1'000);
  CHECK(at_once(runs, device) == 1);
  CHECK(at_once(runs, device, {.jobs = 4, .threads = 0}) == 4);
}

TEST_CASE("sweep schedule: the longest begins first, and the end is balanced", "[sweep]") {
  std::vector<RunSize> runs = equal(5, 1'000);
  const double seconds[] = {1, 4, 2, 4, 3};
  for (std::size_t i = 0; i < 5; ++i) runs[i].seconds = seconds[i];
  CHECK(longest_first(runs) == std::vector<std::size_t>{1, 3, 4, 2, 0});
  const SweepMachine m = machine(2);
  CHECK(SweepSlots(runs, std::vector<int>(5, 1), m, {}).seconds() == Approx(7));
  CHECK(SweepSlots(runs, std::vector<int>(5, 2), m, {}).seconds() == Approx(14));
  runs[2].seconds = std::numeric_limits<double>::quiet_NaN();
  CHECK(longest_first(runs) == std::vector<std::size_t>{2, 1, 3, 4, 0});
}

TEST_CASE("sweep schedule: small runs fill the cores beside one that does not fit", "[sweep]") {
  const std::vector<RunSize> runs{{30'000, gigabyte, 9}, {700'000, gigabyte, 8}, {30'000, gigabyte, 7}, {30'000, gigabyte, 6}};
  const SweepMachine m = machine(16);
  const SweepSlots slots(runs, {1, 16, 1, 1}, m, {});
  CHECK(slots.next({0, 1, 2, 3}, {}) == 0u);
  CHECK(slots.next({1, 2, 3}, {0}) == 2u);
  CHECK(slots.next({1}, {}) == 1u);
}
