// The limit of a parameter between what works and what doesn't, by bisection of its logarithm.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>

namespace corpuscle {

/// Neighbouring values on both sides of a limit. `good` is not a number when nothing in the range worked, `bad` is infinite when all of it did.
struct LimitBracket {
  double good = std::numeric_limits<double>::quiet_NaN();
  double bad = std::numeric_limits<double>::infinity();
  /// The limit itself: their geometric mean, or the end of the range that was reached.
  double limit() const { return std::isfinite(bad) ? (std::isnan(good) ? 0.0 : std::sqrt(good * bad)) : good; }
};

/// Where to look: positive values, and how close the two sides must come.
struct LimitSearch {
  double guess = 1;      ///< tried first; steps of 2 from there until both sides are known
  double lowest = 1e-3;  ///< never tried below
  double highest = 1e3;  ///< nor above
  double ratio = 1.15;   ///< bad/good at the end
};

/// Finds the largest value that works, if all below it do. For a limit from below search for the inverse.
/// @param works called with a value, returns bool; a few times log2(highest/lowest) times at most
template <class Works>
LimitBracket find_limit(const LimitSearch& search, const Works& works) {
  LimitBracket bracket;
  double value = std::clamp(search.guess, search.lowest, search.highest);
  for (double step = 2;; step *= step < 4 ? 2 : 1) {  // steps of 2, then of 4
    if (works(value)) {
      bracket.good = value;
      if (std::isfinite(bracket.bad) || value >= search.highest) break;
      value = std::min(value * step, search.highest);
    } else {
      bracket.bad = value;
      if (!std::isnan(bracket.good) || value <= search.lowest) break;
      value = std::max(value / step, search.lowest);
    }
  }
  if (std::isnan(bracket.good) || !std::isfinite(bracket.bad)) return bracket;
  while (bracket.bad / bracket.good > search.ratio) {
    const double middle = std::sqrt(bracket.good * bracket.bad);
    (works(middle) ? bracket.good : bracket.bad) = middle;
  }
  return bracket;
}

}  // namespace corpuscle
