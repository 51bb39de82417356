// What every number and every curve of the statistics module comes with: its error and whether the two can be trusted.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

namespace corpuscle::statistics {

inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// A number with its standard error (1 sigma). What could not be computed is NaN, and `reason` says why in a sentence.
struct Estimate {
  double value = not_a_number;
  double error = not_a_number;
  double correlation_time = not_a_number;  ///< integrated, in the unit that the function names; NaN where it has no meaning
  double effective_samples = 0;            ///< independent samples or blocks behind the value
  bool converged = false;                  ///< value and error can be trusted
  std::string reason{};                    ///< why not; empty when converged
};

/// Values over an abscissa (lag, distance, velocity ...). Points without data are NaN.
struct Curve {
  Eigen::VectorXd x{}, value{}, error{};
  double trusted_until = std::numeric_limits<double>::infinity();  ///< errors of points further out are too small
  bool converged = false;
  std::string reason{};
};

/// Takes the trust in a result (Estimate, Curve, Fit) away and says why, unless something was wrong before.
template <class Result>
void doubt(Result& result, std::string reason) {
  if (!result.converged) return;
  result.converged = false;
  result.reason = std::move(reason);
}

/// Times (rows) by particles (columns) in any memory layout, NaN where a sample is missing. One component of an array [times][particles][3]:
///   SeriesMatrix y = Eigen::Map<const Eigen::MatrixXd, 0, SeriesStride>(data + 1, times, particles, SeriesStride(3, 3 * particles));
using SeriesStride = Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>;
using SeriesMatrix = Eigen::Ref<const Eigen::MatrixXd, 0, SeriesStride>;

/// How errors are found by resampling: results depend on nothing but the data and these numbers.
struct Resampling {
  int resamples = 200;
  std::uint64_t seed = 1;
};

}  // namespace corpuscle::statistics
