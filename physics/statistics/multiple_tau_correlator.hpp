// Correlations while a run is going on, in memory that doesn't grow with its length.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "physics/statistics/resample.hpp"

namespace corpuscle::statistics {

struct MultipleTauOptions {
  int channels = 16;           ///< p: lags per level; even. Lags of level k are j 2^k samples, j = p/2 ... p-1 (level 0: 0 ... p-1)
  int levels = 20;             ///< longest lag: (p-1) 2^(levels-1) samples
  bool average = false;        ///< coarser levels correlate the means of two samples instead of every second sample: less noise, biased by the averaging
  Eigen::Index blocks = 16;    ///< errors come from between `blocks` and 2 `blocks` stretches of time; even
};

/// Multiple-tau correlator: Magatti & Ferri, Appl. Opt. 40, 4011 (2001); Ramírez, Sukumaran, Vorselaars & Likhtman, J. Chem. Phys. 133, 154103 (2010),
/// with m = 2. Each level keeps its last p samples of every particle and hands every second one (or the mean of two) to the next level, so memory is
/// particles p levels and the work about 2 p operations per particle and sample. Without averaging the results are exactly the sums over the origins
/// that are multiples of 2^k. The sums are kept per stretch of time; when all stretches are full, they are joined in pairs.
class MultipleTauCorrelator {
 public:
  enum class Quantity { autocorrelation, mean_square_displacement };

  MultipleTauCorrelator(Quantity quantity, std::size_t particles, double time_step, const MultipleTauOptions& options = {});

  /// One sample of all particles (fluctuations, or unwrapped positions), NaN where missing. Averages need both samples.
  void add(std::span<const double> values);

  /// Lags that have been seen, in units of the time step's, with the sums per stretch.
  BlockedCurve result() const;

  /// What has been added, as plain numbers for a checkpoint: a correlator that goes on from them has the same results, bit for bit.
  std::vector<double> save() const;
  /// Goes on from `save` of a correlator of the same particles and options. @returns false, and changes nothing, when the numbers can't come from there.
  bool restore(std::span<const double> saved);

  std::int64_t samples() const { return samples_; }
  std::size_t bytes() const;

 private:
  struct Level {
    std::vector<double> history;  // [channels][particles], ring
    std::vector<double> pending;  // first of two samples to be averaged
    std::int64_t received = 0;
    Eigen::MatrixXd sums, counts; // [channels][2 blocks]
  };
  void add_to(std::size_t level, std::span<const double> values);
  void join_stretches();

  Quantity quantity_;
  std::size_t particles_;
  double time_step_;
  MultipleTauOptions options_;
  std::vector<Level> levels_;
  std::int64_t samples_ = 0;
  std::int64_t stretch_ = 1;  // samples a stretch has
};

}  // namespace corpuscle::statistics
