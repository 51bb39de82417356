#include "physics/chebyshev.hpp"

#include <cmath>

#include "tests/catch.hpp"

using namespace corpuscle;

namespace {

/// One unit of time of y' = constant - eigenvalue y from y = start.
double integrate(int s, double eigenvalue, double constant, double start) {
  const ChebyshevScheme scheme(s);
  const auto rate = [&](double y) { return constant - eigenvalue * y; };
  double last = start, y = start + scheme.first * rate(start);
  for (const auto& stage : scheme.stages) {
    const double next = stage.mu * y + (1 - stage.mu) * last + stage.step * rate(y);
    last = y;
    y = next;
  }
  return y;
}

}  // namespace

TEST_CASE("Chebyshev stages are exact for a constant rate and first order else", "[chebyshev]") {
  for (const int s : {1, 2, 5, 12}) {
    CHECK(integrate(s, 0, 0.7, 1) == Approx(1.7).epsilon(1e-12));
    // Error of one step of a first-order scheme: of the order of (eigenvalue)^2/2, so a tenth of the eigenvalue gives a hundredth of the error.
    const double coarse = std::abs(integrate(s, 1e-2, 0, 1) - std::exp(-1e-2)), fine = std::abs(integrate(s, 1e-3, 0, 1) - std::exp(-1e-3));
    CHECK(coarse < 0.5e-4);
    CHECK(coarse / fine == Approx(100).epsilon(0.02));
  }
}

TEST_CASE("Chebyshev stages are stable up to their reach, which grows with the square of their number", "[chebyshev]") {
  CHECK(ChebyshevScheme::reach(1) == Approx(2).epsilon(0.05));
  for (const int s : {1, 2, 3, 8, 20, 64}) {
    const double reach = ChebyshevScheme::reach(s);
    CHECK(reach == Approx(1.93 * s * s).epsilon(0.07));
    double largest = 0;
    for (int i = 1; i <= 1000; ++i) largest = std::max(largest, std::abs(integrate(s, reach * i / 1000, 0, 1)));
    CHECK(largest <= 1 + 1e-9);
    CHECK(std::abs(integrate(s, 1.1 * reach, 0, 1)) > 1);
    CHECK(ChebyshevScheme::stages_for(reach * 0.999) == s);
    CHECK(ChebyshevScheme::stages_for(reach * 1.001) == s + 1);
  }
  CHECK(ChebyshevScheme::stages_for(0) == 1);
}
