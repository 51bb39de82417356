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

std::vector<std::pair<const char*, double>> named_units(const SiUnits& units) {
  std::vector<std::pair<const char*, double>> named;
  if (units.length) named.emplace_back("unit_length_m", *units.length);
  if (units.force) named.emplace_back("unit_force_N", *units.force);
  if (units.time) named.emplace_back("unit_time_s", *units.time);
  return named;
}

}  // namespace corpuscle
