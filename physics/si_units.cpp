#include "physics/si_units.hpp"

namespace corpuscle {

SiUnits si_units(const SiSpec& si, double radius, double kappa, double viscosity) {
  SiUnits units;
  if (!si.radius) return units;
  units.length = *si.radius / radius;
  if (!si.shear_modulus || !(kappa > 0)) return units;
  units.force = 3 * *si.shear_modulus / kappa * *units.length;  // a modulus is a force over a length
  if (si.viscosity) units.time = *si.viscosity / viscosity * *units.length * *units.length / *units.force;  // a viscosity is force * time / area
  return units;
}

}  // namespace corpuscle
