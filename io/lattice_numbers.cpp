#include "io/lattice_numbers.hpp"

namespace corpuscle {

NamedNumbers named_numbers(const LatticeParameters& l) {
  NamedNumbers numbers{{"radius", l.radius},
                       {"relaxation_time", l.relaxation_time},
                       {"viscosity", l.viscosity},
                       {"shear_rate", l.shear_rate},
                       {"wall_velocity", l.wall_velocity},
                       {"body_force", l.body_force},
                       {"capillary_number", l.capillary_number},
                       {"reynolds_number", l.reynolds_number},
                       {"mach_number", l.mach_number},
                       {"phi_geometric", l.phi_geometric},
                       {"phi_nominal", l.phi_nominal},
                       {"phi_effective", l.phi_effective},
                       {"contact_strength", l.contact_strength},
                       {"contact_range", l.contact_range},
                       {"membrane_time", l.membrane_time},
                       {"steps_per_strain", l.steps_per_strain}};
  for (const auto& unit : named_units(l.si)) numbers.push_back(unit);
  return numbers;
}

NamedNumbers named_numbers(const CellTypeLattice& t) {
  return {{"radius", t.radius},
          {"mesh_radius", t.mesh_radius},
          {"shell_thickness", t.shell_thickness},
          {"counted_shell", t.counted_shell},
          {"effective_radius", t.effective_radius},
          {"volume", t.volume},
          {"nominal_volume", t.nominal_volume},
          {"area", t.area},
          {"effective_volume", t.effective_volume},
          {"shear_modulus", t.moduli.shear},
          {"area_dilation_modulus", t.moduli.area_dilation},
          {"bending_modulus", t.moduli.bending},
          {"bending_constant", t.moduli.bending_constant},
          {"global_area_modulus", t.moduli.global_area},
          {"volume_modulus", t.moduli.volume},
          {"stretching_force", t.stretching_force}};
}

NamedIntegers named_integers(const CellTypeLattice& t) { return {{"count", t.count}, {"subdivision", t.subdivision}, {"vertices", t.vertices}, {"faces", t.faces}}; }

}  // namespace corpuscle
