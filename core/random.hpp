// Counter-based random numbers: the k-th draw of a stream is a function of (seed, stream, k), so it is the same on every machine, for any
// number of threads, on host and device. No std:: distribution: their results differ between standard libraries.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>

namespace corpuscle {

/// Finaliser of splitmix64 (Steele, Lea & Flood 2014; constants of Stafford's variant 13): a bijection that mixes all bits.
constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// Uniform in [0, 1): the upper 53 bits, every value a multiple of 2^-53 and exact.
constexpr double uniform_from_bits(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

/// A stream of draws. Copy it to branch, give every object its own `stream` number to draw independently of all others.
class RandomStream {
 public:
  constexpr explicit RandomStream(std::uint64_t seed, std::uint64_t stream = 0, std::uint64_t counter = 0)
      : key_(mix_bits(mix_bits(seed + golden) ^ mix_bits(stream + 2 * golden))), counter_(counter) {}

  constexpr std::uint64_t bits() { return mix_bits(key_ + golden * ++counter_); }
  constexpr double uniform() { return uniform_from_bits(bits()); }
  constexpr double uniform(double from, double to) { return from + (to - from) * uniform(); }

 private:
  static constexpr std::uint64_t golden = 0x9e3779b97f4a7c15ULL;  // 2^64 / golden ratio, odd: the counter visits all states
  std::uint64_t key_;
  std::uint64_t counter_;
};

/// Uniformly distributed rotation as a unit quaternion (w, x, y, z), w >= 0: a point drawn in the unit ball of R^4 by rejection and projected
/// (acceptance 31 %). Only + * / sqrt, which IEEE 754 fixes, unlike sin and cos.
inline std::array<double, 4> random_rotation(RandomStream& random) {
  for (;;) {
    std::array<double, 4> q;
    double norm2 = 0;
    for (double& component : q) {
      component = random.uniform(-1, 1);
      norm2 += component * component;
    }
    if (norm2 > 1 || norm2 < 1e-4) continue;
    const double scale = (q[0] < 0 ? -1 : 1) / std::sqrt(norm2);
    for (double& component : q) component *= scale;
    return q;
  }
}

}  // namespace corpuscle
