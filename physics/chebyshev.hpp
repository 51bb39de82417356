// Runge-Kutta-Chebyshev scheme of first order: s stages of an explicit method whose stability grows with s^2.
#pragma once
#include <vector>

namespace corpuscle {

/// Coefficients of y' = f(y) over one unit of time (van der Houwen, Sommeijer, Z. Angew. Math. Mech. 60, 479 (1980); Verwer, Appl. Numer. Math. 22, 359 (1996)):
///   y_1 = y_0 + first f(y_0),   y_j = mu y_{j-1} + (1 - mu) y_{j-2} + step f(y_{j-1}),   y(1) = y_s.
/// Stable where the eigenvalues of -df/dy lie in [0, reach(s)]; a little damping (5 %) keeps the polynomial below 1 inside.
struct ChebyshevScheme {
  struct Stage {
    double mu, step;
  };
  double first = 1;
  std::vector<Stage> stages;  ///< of j = 2 ... s

  explicit ChebyshevScheme(int s);

  /// Largest eigenvalue that s stages can take, about 1.93 s^2.
  static double reach(int s);
  /// Smallest number of stages that reach this eigenvalue.
  static int stages_for(double eigenvalue);
};

}  // namespace corpuscle
