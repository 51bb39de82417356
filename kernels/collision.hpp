// Collision on one node: equilibrium, two-relaxation-time (or BGK) relaxation and Guo forcing. Knows nothing of storage.
// Guo, Zheng, Shi, PRE 65, 046308 (2002); Ginzburg, Verhaeghe, d'Humieres, Commun. Comput. Phys. 3, 427 (2008).
#pragma once
#include "kernels/velocity_set.hpp"

namespace corpuscle {

/// Density deviation rho - 1 and velocity of a node.
template <class Real>
struct Macroscopic {
  Real density_shift;
  Real u[3];
};

/// Moments of shifted populations g = f - w; `force` is the force density, u = (sum c f + F/2)/rho.
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Macroscopic<Real> macroscopic(const Real (&g)[19], const Real fx, const Real fy, const Real fz) {
  Real even = g[0], jx = fx * Real(0.5), jy = fy * Real(0.5), jz = fz * Real(0.5);
  unroll<D3Q19::pairs>([&](auto p) {
    constexpr int a = 2 * decltype(p)::value + 1;
    even += g[a] + g[a + 1];
    const Real odd = g[a] - g[a + 1];
    constexpr int cx = D3Q19::cx[a], cy = D3Q19::cy[a], cz = D3Q19::cz[a];
    if constexpr (cx != 0) jx += Real(cx) * odd;
    if constexpr (cy != 0) jy += Real(cy) * odd;
    if constexpr (cz != 0) jz += Real(cz) * odd;
  });
  const Real inverse = Real(1) / (Real(1) + even);
  return {even, {jx * inverse, jy * inverse, jz * inverse}};
}

/// Scalar product with the direction q, without multiplications by the compile-time 0 and +-1.
template <int q, class Real>
KOKKOS_FORCEINLINE_FUNCTION Real along(const Real x, const Real y, const Real z) {
  Real sum = 0;
  constexpr int cx = D3Q19::cx[q], cy = D3Q19::cy[q], cz = D3Q19::cz[q];
  if constexpr (cx != 0) sum += Real(cx) * x;
  if constexpr (cy != 0) sum += Real(cy) * y;
  if constexpr (cz != 0) sum += Real(cz) * z;
  return sum;
}

/// Relaxes the even and odd part of every pair at their own rate. BGK: both 1/tau. TRT: the odd rate follows from Lambda.
/// TRT costs what BGK costs, so that one body serves both.
template <class Real>
struct PairRelaxation {
  Real omega_even;
  Real omega_odd;

  static PairRelaxation bgk(double relaxation_time) { return {rate(1.0 / relaxation_time), rate(1.0 / relaxation_time)}; }
  /// Lambda = (tau+ - 1/2)(tau- - 1/2); 3/16 puts half-way walls exactly half-way.
  static PairRelaxation trt(double relaxation_time, double magic_parameter) {
    return {rate(1.0 / relaxation_time), rate(1.0 / (0.5 + magic_parameter / (relaxation_time - 0.5)))};
  }
  /// A rate is rounded so that 1 - omega is exact: what relaxation takes from a moment and what it leaves of it add up, at every one of millions of steps.
  static Real rate(double omega) { return omega < 0.5 ? Real(1) - Real(1 - omega) : Real(omega); }

  /// Collides the shifted populations in place. With `Forced` false the force is taken to be zero and costs nothing.
  ///
  /// Of a pair with the direction c and the weight w, equilibrium and Guo's source are, multiplied out,
  ///   even part: w (s + (c.u)(c.v)),   s = omega+ (rho - 1 - 3/2 rho u^2) - 3 (1 - omega+/2) u.F,   v = 9/2 omega+ rho u + 9 (1 - omega+/2) F
  ///   odd part:  w c.t,                t = 3 omega- rho u + 3 (1 - omega-/2) F
  /// so that a node computes s, v and t once and a pair little: collision under a force is limited by arithmetic (docs/performance.md).
  template <bool Forced>
  KOKKOS_FORCEINLINE_FUNCTION void collide(Real (&g)[19], const Macroscopic<Real>& m, const Real fx, const Real fy, const Real fz) const {
    const Real rho = Real(1) + m.density_shift;
    const Real ux = m.u[0], uy = m.u[1], uz = m.u[2];
    const Real of_even = Real(4.5) * omega_even * rho, of_odd = Real(3) * omega_odd * rho;
    Real s = omega_even * (m.density_shift - Real(1.5) * rho * (ux * ux + uy * uy + uz * uz));
    Real vx = of_even * ux, vy = of_even * uy, vz = of_even * uz;
    Real tx = of_odd * ux, ty = of_odd * uy, tz = of_odd * uz;
    if constexpr (Forced) {
      const Real half_even = Real(3) - Real(1.5) * omega_even, half_odd = Real(3) - Real(1.5) * omega_odd;
      s -= half_even * (ux * fx + uy * fy + uz * fz);
      vx += Real(3) * half_even * fx, vy += Real(3) * half_even * fy, vz += Real(3) * half_even * fz;
      tx += half_odd * fx, ty += half_odd * fy, tz += half_odd * fz;
    }
    const Real keep_even = Real(0.5) * (Real(1) - omega_even), keep_odd = Real(0.5) * (Real(1) - omega_odd);
    g[0] = (Real(1) - omega_even) * g[0] + Real(D3Q19::rest_weight) * s;
    unroll<D3Q19::pairs>([&](auto p) {
      constexpr int a = 2 * decltype(p)::value + 1;
      constexpr Real w = Real(D3Q19::weight(a));
      const Real even = keep_even * (g[a] + g[a + 1]) + w * (s + along<a>(ux, uy, uz) * along<a>(vx, vy, vz));
      const Real odd = keep_odd * (g[a] - g[a + 1]) + w * along<a>(tx, ty, tz);
      g[a] = even + odd;
      g[a + 1] = even - odd;
    });
  }
};

/// Shifted equilibrium plus the non-equilibrium part of a velocity gradient dux/dz (first order in Chapman-Enskog): the exact state of a plane shear flow.
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void equilibrium_with_shear(Real (&g)[19], const Macroscopic<Real>& m, const Real dux_dz, const Real relaxation_time) {
  const Real rho = Real(1) + m.density_shift;
  const Real speed_term = m.density_shift - Real(1.5) * rho * (m.u[0] * m.u[0] + m.u[1] * m.u[1] + m.u[2] * m.u[2]);
  unroll<D3Q19::directions>([&](auto q) {
    constexpr int i = decltype(q)::value;
    constexpr Real w = Real(D3Q19::weight(i)), cx_cz = Real(D3Q19::cx[i] * D3Q19::cz[i]);
    const Real cu = along<i>(m.u[0], m.u[1], m.u[2]);
    g[i] = w * (speed_term + rho * (Real(3) * cu + Real(4.5) * cu * cu) - Real(3) * relaxation_time * rho * cx_cz * dux_dz);
  });
}

}  // namespace corpuscle
