// The loops that set the bandwidth roof: in-place update and copy, driven like the lattice kernels.
#pragma once
#include <algorithm>

#include "core/lattice_for.hpp"

namespace corpuscle::perf {

/// x[i] = a x[i] + b: the traffic pattern of in-place streaming.
struct UpdateInPlace {
  Array1<float> x;
  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int i) const { x(i) = 0.5f * x(i) + 1.0f; }
};
struct CopyArray {
  Array1<float> from, to;
  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int i) const { to(i) = from(i); }
};

/// Rows of a few pages each, as many as make `numbers`.
inline Grid rows_of(std::size_t numbers) {
  constexpr int row = 4096;
  const int length = int(std::min<std::size_t>(numbers, row));
  return {length, int(std::max<std::size_t>(1, numbers / row)), 1, 0};
}

/// An array of `bytes` that is read and written once a call.
class InPlace {
 public:
  explicit InPlace(double bytes) : grid_(rows_of(std::size_t(bytes) / sizeof(float))), body_{Array1<float>("in_place", grid_.padded_nodes())} {}
  void operator()() const { lattice_for("in_place", grid_, interior(grid_), body_); }
  double traffic() const { return 2.0 * sizeof(float) * double(grid_.nodes()); }  ///< bytes a call, read and written

 private:
  Grid grid_;
  UpdateInPlace body_;
};

/// Two arrays of `bytes` together, one copied to the other. The write-allocate of the target isn't counted.
class Copy {
 public:
  explicit Copy(double bytes)
      : grid_(rows_of(std::size_t(bytes) / 2 / sizeof(float))),
        body_{Array1<float>("copy_from", grid_.padded_nodes()), Array1<float>("copy_to", grid_.padded_nodes())} {}
  void operator()() const { lattice_for("copy", grid_, interior(grid_), body_); }
  double traffic() const { return 2.0 * sizeof(float) * double(grid_.nodes()); }

 private:
  Grid grid_;
  CopyArray body_;
};

}  // namespace corpuscle::perf
