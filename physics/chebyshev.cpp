#include "physics/chebyshev.hpp"

#include <cmath>

namespace corpuscle {
namespace {

constexpr double damping = 0.05;

/// Chebyshev polynomial and its derivative for j = 0 ... s at w0 = 1 + damping/s^2.
struct Polynomials {
  double w0;
  std::vector<double> t, slope;
  explicit Polynomials(int s) : w0(1 + damping / (double(s) * s)), t(s + 1), slope(s + 1) {
    t[0] = 1;
    slope[0] = 0;
    t[1] = w0;
    slope[1] = 1;
    for (int j = 2; j <= s; ++j) {
      t[j] = 2 * w0 * t[j - 1] - t[j - 2];
      slope[j] = 2 * t[j - 1] + 2 * w0 * slope[j - 1] - slope[j - 2];
    }
  }
};

}  // namespace

ChebyshevScheme::ChebyshevScheme(int s) {
  const Polynomials p(s);
  const double w1 = p.t[s] / p.slope[s];
  first = w1 / p.w0;
  for (int j = 2; j <= s; ++j) stages.push_back({2 * p.w0 * p.t[j - 1] / p.t[j], 2 * w1 * p.t[j - 1] / p.t[j]});
}

double ChebyshevScheme::reach(int s) {
  const Polynomials p(s);
  return (p.w0 + 1) * p.slope[s] / p.t[s];
}

int ChebyshevScheme::stages_for(double eigenvalue) {
  int s = 1;
  while (reach(s) < eigenvalue) ++s;
  return s;
}

}  // namespace corpuscle
