// Where neighbours are: g(r) of cell centres and the number of contacts.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "physics/statistics/resample.hpp"

namespace corpuscle::statistics {

struct PairOptions {
  std::array<double, 3> size{};                          ///< of the box, any unit of length
  std::array<double, 3> origin{};                        ///< its lower corner: matters where there are walls
  std::array<bool, 3> periodic{true, true, false};       ///< a direction that isn't has walls
  double reach = 0;                                      ///< largest distance; at most half of each periodic size
  Eigen::Index bins = 100;
  double wall_layer = 0;                                 ///< centres nearer to a wall are neighbours, but have no g(r) of their own
  double contact_distance = 0;                           ///< neighbours nearer than this are in contact; at most `reach`
};

/// g(r) = pairs found in a shell over those expected if neighbours were independent: density of the region of the centres, (n-1)/volume for n centres in
/// it, times the volume of the part of the shell that lies between the walls (Allen & Tildesley 1987, ch. 6.2; the shell's cut by walls is exact).
/// Work per snapshot: pairs whose z differ by less than the reach. Memory doesn't grow: snapshots are joined into at most 32 blocks.
class PairDistribution {
 public:
  explicit PairDistribution(const PairOptions& options);

  /// One snapshot: centres [n][3], in the box or unwrapped. Centres with NaN are left out.
  void add(std::span<const double> centres);

  /// g(r), x = mid-distance of the bins, blocks of consecutive snapshots.
  BlockedCurve result() const;

  /// Mean number of neighbours within the contact distance. Snapshots count as blocks; correlated ones make its error too small unless they join.
  Estimate contact_number(const Resampling& resampling = {}) const;

 private:
  void join_blocks();
  double volume_within(double radius, double z_down, double z_up) const;

  PairOptions options_;
  std::string refusal_;
  Eigen::MatrixXd pairs_, expected_;    // [bins][blocks]
  Eigen::MatrixXd contacts_, centres_;  // [1][blocks]
  std::int64_t snapshots_ = 0, per_block_ = 1;
};

}  // namespace corpuscle::statistics
