#include "physics/statistics/correlation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>
#include <vector>

namespace corpuscle::statistics {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Spectrum = Eigen::VectorXcd;

// Smallest size of the form 4 2^a 3^b 5^c: kissfft is fast on those, and its real transforms need a multiple of four.
Index fast_size(Index least) {
  for (Index size = (least + 3) / 4 * 4;; size += 4) {
    Index rest = size;
    for (const Index factor : {2, 3, 5}) {
      while (rest % factor == 0) rest /= factor;
    }
    if (rest == 1) return size;
  }
}

class Transform {
 public:
  explicit Transform(Index size) : size_(size) { fft_.SetFlag(Eigen::FFT<double>::HalfSpectrum); }
  const Spectrum& forward(const VectorXd& signal) {
    padded_.setZero(size_);
    padded_.head(signal.size()) = signal;
    fft_.fwd(spectrum_, padded_);
    return spectrum_;
  }
  VectorXd backward(const Spectrum& spectrum, Index lags) {
    fft_.inv(padded_, spectrum, size_);
    return padded_.head(lags);
  }
  Index bins() const { return size_ / 2 + 1; }

 private:
  Eigen::FFT<double> fft_;
  Index size_;
  VectorXd padded_;
  Spectrum spectrum_;
};

// A product of an early and a late signal whose correlations add up to the wanted sum, and those that add up to the number of pairs.
struct Signals {
  std::vector<VectorXd> early, late;
  VectorXd early_valid, late_valid;
};

struct Layout {
  Index times = 0, particles = 0, lags = 0, blocks = 0;
  std::string reason;
};

Layout layout_of(Index times, Index particles, const CorrelationOptions& options) {
  Layout layout{.times = times, .particles = particles, .lags = 0, .blocks = 0, .reason = {}};
  if (particles < 1) {
    layout.reason = "there is no particle";
  } else if (times < 4) {
    layout.reason = fmt::format("{} samples in time are too few for a correlation (at least 4)", times);
  } else {
    const Index longest = options.longest_lag > 0 ? options.longest_lag : times / 4;
    layout.lags = std::min(longest, times - 1) + 1;
    const Index independent = options.blocks_of == Blocks::times ? times : particles;
    layout.blocks = std::clamp<Index>(options.blocks, 1, independent);
  }
  return layout;
}

// Sums over pairs (s, s+t) with the origin s in a block. `signals(p)` gives the signals of particle p over all times.
template <class SignalsOf>
BlockedCurve correlate(const Layout& layout, const CorrelationOptions& options, double time_step, const SignalsOf& signals_of) {
  BlockedCurve curve;
  curve.reason = layout.reason;
  if (!layout.reason.empty()) return curve;
  const auto [times, particles, lags, blocks, reason] = layout;
  curve.x = VectorXd::LinSpaced(lags, 0, static_cast<double>(lags - 1) * time_step);
  curve.sums = curve.counts = Eigen::MatrixXd::Zero(lags, blocks);

  const bool over_time = options.blocks_of == Blocks::times;
  const Index stretches = over_time ? blocks : 1;
  const Index longest = (times + stretches - 1) / stretches;
  Transform transform(fast_size(std::min(longest + lags, times + lags)));
  std::vector<Spectrum> sums(static_cast<std::size_t>(blocks), Spectrum::Zero(transform.bins()));
  std::vector<Spectrum> counts = sums;
  bool gaps = false;
  std::vector<Index> complete(static_cast<std::size_t>(blocks), 0);  // particles without gaps need no transform to count their pairs

  for (Index p = 0; p < particles; ++p) {
    const Signals signals = signals_of(p);
    const bool whole = signals.early_valid.minCoeff() > 0 && signals.late_valid.minCoeff() > 0;
    gaps = gaps || !whole;
    for (Index stretch = 0; stretch < stretches; ++stretch) {
      const auto b = static_cast<std::size_t>(over_time ? stretch : p * blocks / particles);
      const Index from = stretch * times / stretches, to = (stretch + 1) * times / stretches;
      const Index reach = std::min(to + lags - 1, times) - from;
      const auto add = [&](const VectorXd& early, const VectorXd& late, Spectrum& sum) {
        const Spectrum origin = transform.forward(early.segment(from, to - from));
        sum += origin.conjugate().cwiseProduct(transform.forward(late.segment(from, reach)));
      };
      for (std::size_t i = 0; i < signals.early.size(); ++i) add(signals.early[i], signals.late[i], sums[b]);
      if (whole) {
        ++complete[b];
      } else {
        add(signals.early_valid, signals.late_valid, counts[b]);
      }
    }
  }
  for (Index b = 0; b < blocks; ++b) {
    const auto i = static_cast<std::size_t>(b);
    curve.sums.col(b) = transform.backward(sums[i], lags);
    if (gaps) curve.counts.col(b) = transform.backward(counts[i], lags).array().round();
    const Index from = over_time ? b * times / stretches : 0, to = over_time ? (b + 1) * times / stretches : times;
    for (Index lag = 0; lag < lags; ++lag) {
      const Index pairs = std::max<Index>(std::min(to, times - lag) - from, 0);
      curve.counts(lag, b) += static_cast<double>(complete[i] * pairs);
    }
  }
  // Where there is no pair the transform leaves rounding.
  curve.sums = (curve.counts.array() > 0).select(curve.sums, 0.0);
  if (over_time) curve.block_length = static_cast<double>(times / blocks) * time_step;
  if ((curve.counts.row(0).array() <= 0).all()) curve.reason = "there is no valid sample";
  return curve;
}

VectorXd validity(const VectorXd& x) { return x.array().isNaN().select(VectorXd::Zero(x.size()), VectorXd::Ones(x.size())); }
VectorXd without_gaps(const VectorXd& x) { return x.array().isNaN().select(VectorXd::Zero(x.size()), x); }

double mean_of_valid(const SeriesMatrix& series) {
  double sum = 0, count = 0;
  for (Index p = 0; p < series.cols(); ++p) {
    const VectorXd column = series.col(p);
    sum += without_gaps(column).sum();
    count += validity(column).sum();
  }
  return count > 0 ? sum / count : 0;
}

VectorXd deviations(const VectorXd& x, MeanRemoval removal, double overall) {
  double mean = overall;
  if (removal == MeanRemoval::particle) {
    const double valid = validity(x).sum();
    mean = valid > 0 ? without_gaps(x).sum() / valid : 0;
  }
  return without_gaps((x.array() - mean).matrix());
}

BlockedCurve of_different_shapes(const SeriesMatrix& a, const SeriesMatrix& b) {
  BlockedCurve curve;
  curve.reason = fmt::format("the series have different shapes: {} x {} and {} x {}", a.rows(), a.cols(), b.rows(), b.cols());
  return curve;
}

}  // namespace

BlockedCurve cross_correlation(const SeriesMatrix& a, const SeriesMatrix& b, double time_step, const CorrelationOptions& options) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) return of_different_shapes(a, b);
  const bool remove = options.removal == MeanRemoval::overall;
  const double mean_a = remove ? mean_of_valid(a) : 0, mean_b = remove ? mean_of_valid(b) : 0;
  return correlate(layout_of(a.rows(), a.cols(), options), options, time_step, [&](Index p) {
    const VectorXd early = a.col(p), late = b.col(p);
    return Signals{{deviations(early, options.removal, mean_a)}, {deviations(late, options.removal, mean_b)}, validity(early), validity(late)};
  });
}

BlockedCurve autocorrelation(const SeriesMatrix& series, double time_step, const CorrelationOptions& options) {
  return cross_correlation(series, series, time_step, options);
}

BlockedCurve mean_square_displacement(const SeriesMatrix& positions, const SeriesMatrix& origins, double time_step, const CorrelationOptions& options) {
  if (positions.rows() != origins.rows() || positions.cols() != origins.cols()) return of_different_shapes(positions, origins);
  BlockedCurve msd = correlate(layout_of(positions.rows(), positions.cols(), options), options, time_step, [&](Index p) {
    const VectorXd x = positions.col(p);
    const VectorXd valid = validity(x), y = deviations(x, MeanRemoval::particle, 0), squares = y.cwiseAbs2();
    const VectorXd from = valid.cwiseProduct(validity(origins.col(p)));
    return Signals{{from.cwiseProduct(squares), from, (-2 * from.cwiseProduct(y)).eval()}, {valid, squares, y}, from, valid};
  });
  if (msd.points() > 0) msd.sums.row(0).setZero();
  msd.sums = msd.sums.cwiseMax(0);
  return msd;
}

BlockedCurve mean_square_displacement(const SeriesMatrix& positions, double time_step, const CorrelationOptions& options) {
  return mean_square_displacement(positions, positions, time_step, options);
}

VectorXd local_exponent(const VectorXd& x, const VectorXd& y, double reach) {
  VectorXd exponent = VectorXd::Constant(x.size(), not_a_number);
  const double width = std::log(reach) * (1 + 1e-9);
  for (Index i = 0; i < x.size(); ++i) {
    if (!(x[i] > 0)) continue;
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    const auto add = [&](Index j) {
      if (!(x[j] > 0) || std::abs(std::log(x[j] / x[i])) > width) return false;
      if (!(y[j] > 0)) return true;
      const double u = std::log(x[j] / x[i]), v = std::log(y[j]);
      n += 1, sx += u, sy += v, sxx += u * u, sxy += u * v;
      return true;
    };
    for (Index j = i; j < x.size() && add(j); ++j) {}
    for (Index j = i - 1; j >= 0 && add(j); --j) {}
    if (n >= 3) exponent[i] = (n * sxy - sx * sy) / (n * sxx - sx * sx);
  }
  return exponent;
}

Curve local_exponent(const BlockedCurve& curve, double reach, const Resampling& resampling) {
  return with_errors(curve, [&](const VectorXd& y) { return local_exponent(curve.x, y, reach); }, resampling);
}

Curve normalised(const BlockedCurve& correlation, const Resampling& resampling) {
  Curve curve = with_errors(correlation, [](const VectorXd& c) { return VectorXd(c * (c.size() > 0 && c[0] > 0 ? 1 / c[0] : not_a_number)); }, resampling);
  if (correlation.reason.empty() && curve.value.size() > 0 && std::isnan(curve.value[0])) {
    curve.converged = false;
    curve.reason = "the series is constant: its correlation has no shape";
  }
  return curve;
}

BlockedCurve thinned(const BlockedCurve& curve, int per_octave) {
  std::vector<Index> keep;
  const double step = std::exp2(1.0 / std::max(per_octave, 1));
  double next = 0;
  for (Index i = 0; i < curve.points(); ++i) {
    if (i < next && i + 1 < curve.points()) continue;
    keep.push_back(i);
    next = std::max(static_cast<double>(i) + 1, static_cast<double>(i) * step);
  }
  BlockedCurve few = curve;
  const auto n = static_cast<Index>(keep.size());
  few.x.resize(n);
  few.sums.resize(n, curve.blocks());
  few.counts.resize(n, curve.blocks());
  for (Index i = 0; i < n; ++i) {
    const Index from = keep[static_cast<std::size_t>(i)];
    few.x[i] = curve.x[from];
    few.sums.row(i) = curve.sums.row(from);
    few.counts.row(i) = curve.counts.row(from);
  }
  return few;
}

}  // namespace corpuscle::statistics
