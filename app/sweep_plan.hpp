// The points of a sweep before anything runs: lattice parameters, memory, time.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "io/sweep.hpp"
#include "physics/problem.hpp"
#include "physics/units.hpp"

namespace corpuscle::app {

struct PlannedPoint {
  SweepPoint point;
  Problem problem;
  LatticeParameters lattice;
  std::int64_t cells = 0;
  double bytes = 0;  ///< MemoryEstimate::peak
};

/// A point that can't be run, and why.
struct RefusedPoint {
  std::size_t point = 0;  ///< of the sweep
  std::string reason;
};

/// Reads and plans each scene; allocates none. @throws InputError that lists every point that can't be run, with what is wrong with it, unless `refused` takes them.
std::vector<PlannedPoint> plan_points(const Sweep& sweep, std::vector<RefusedPoint>* refused = nullptr);

/// Warnings of all points, each text once with the points that it is about.
std::vector<std::string> warnings_of(const std::vector<PlannedPoint>& points);

/// Seconds a step of each point with so many threads, from short measurements on this machine: one for all points that differ only in their flow, seed, guards,
/// length and output. Done in processes of their own, so that Kokkos isn't started in this one. NaN where the measurement failed.
std::vector<double> seconds_per_step(const std::vector<const PlannedPoint*>& points, const std::vector<int>& threads);

}  // namespace corpuscle::app
