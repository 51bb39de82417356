// In-plane elastic energy densities w(I1, I2) of a membrane, I1 = l1^2 + l2^2 - 2, I2 = l1^2 l2^2 - 1 (docs/theory/model.md, Membrane).
// A new law is a struct like these and one line in physics/membrane.cpp.
#pragma once
#include <Kokkos_Macros.hpp>

namespace corpuscle {

/// Skalak et al., Biophys. J. 13, 245 (1973), in Krueger's normalisation: w = kappa_S/12 (I1^2 + 2 I1 - 2 I2) + kappa_alpha/12 I2^2.
struct Skalak {
  double shear;          ///< kappa_S = 3 G_s
  double area_dilation;  ///< kappa_alpha
  template <class T>
  KOKKOS_FORCEINLINE_FUNCTION void derivatives(const T& i1, const T& i2, T& dw_di1, T& dw_di2) const {
    dw_di1 = T(shear / 6) * (i1 + T(1));
    dw_di2 = T(area_dilation / 6) * i2 - T(shear / 6);
  }
  double energy_density(double i1, double i2) const {
    return shear / 12 * (i1 * i1 + 2 * i1 - 2 * i2) + area_dilation / 12 * i2 * i2;
  }
};

/// Neo-Hookean membrane: w = G_s/2 (I1 - 1 + 1/(I2 + 1)), zero at rest.
struct NeoHookean {
  double shear;  ///< kappa_S = 3 G_s
  template <class T>
  KOKKOS_FORCEINLINE_FUNCTION void derivatives(const T&, const T& i2, T& dw_di1, T& dw_di2) const {
    const T inverse = T(1) / (i2 + T(1));
    dw_di1 = T(shear / 6);
    dw_di2 = T(-shear / 6) * inverse * inverse;
  }
  double energy_density(double i1, double i2) const { return shear / 6 * (i1 - 1 + 1 / (i2 + 1)); }
};

}  // namespace corpuscle
