// Bandwidth of copy and in-place update over the size of the arrays, and the arithmetic peak: the roofs of the roofline.
#include <fmt/format.h>

#include "perf/report.hpp"
#include "perf/stream.hpp"
#include "perf/timing.hpp"

using namespace corpuscle;
using namespace corpuscle::perf;

namespace {

constexpr int chains = 12, links = 32;

/// Independent chains of multiply-adds in registers: 2 * chains * links operations an element.
template <class Real>
struct MultiplyAdd {
  Array1<Real> x;
  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int i) const {
    Real a[chains];
    for (int c = 0; c < chains; ++c) a[c] = x(i) + Real(c);
    const Real factor = x(i);
#pragma GCC unroll 32
    for (int l = 0; l < links; ++l)
#pragma GCC unroll 12
      for (int c = 0; c < chains; ++c) a[c] = a[c] * factor + Real(0.25);
    Real sum = 0;
    for (int c = 0; c < chains; ++c) sum += a[c];
    x(i) = sum * Real(1e-9) + Real(0.5);
  }
};

template <class Real>
void peak(Section& section, const char* name) {
  const Grid grid{1024, 64, 1, 0};
  const MultiplyAdd<Real> body{Array1<Real>("peak", grid.padded_nodes())};
  const double seconds = best_of([&] { lattice_for("peak", grid, interior(grid), body); }, section.effort());
  section.row(name, {{"GFLOPS", 2.0 * chains * links * double(grid.nodes()) / seconds / 1e9}});
}

}  // namespace

int main(int argc, char** argv) {
  Section section(argc, argv, "bandwidth", "Read plus written bytes a second over the memory touched; peak of multiply-adds in registers.",
                  {{"in_place_GB_s", "higher"}, {"copy_GB_s", "higher"}, {"GFLOPS", "higher"}});
  Kokkos::ScopeGuard scope(argc, argv);
  for (const double mebibytes : {0.5, 2.0, 8.0, 32.0, 128.0, 256.0, 512.0, 1024.0}) {
    const double bytes = mebibytes * 1048576;
    if (section.effort().quick && mebibytes > 2) break;
    if (bytes * 2 > 0.8 * available_bytes()) break;
    const InPlace update(bytes);
    const Copy copy(bytes);
    const auto seconds = interleaved_seconds({update, copy}, section.effort());
    section.row(fmt::format("{:g} MiB", mebibytes),
                {{"MiB", mebibytes}, {"in_place_GB_s", update.traffic() / seconds[0] / 1e9}, {"copy_GB_s", copy.traffic() / seconds[1] / 1e9}});
  }
  peak<float>(section, "peak, float");
  peak<double>(section, "peak, double");
  return section.finish();
}
