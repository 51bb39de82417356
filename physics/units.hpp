// From dimensionless numbers to lattice parameters (docs/theory/model.md, "Units and dimensionless numbers").
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "physics/problem.hpp"
#include "physics/si_units.hpp"

namespace corpuscle {

/// c_s of the lattice, 1/sqrt(3).
inline const double speed_of_sound = 1 / std::sqrt(3.0);

/// Elastic moduli of one cell type in lattice units.
struct MembraneModuli {
  StrainLawKind law = StrainLawKind::skalak;
  double shear = 0;             ///< kappa_S = 3 G_s
  double area_dilation = 0;     ///< kappa_alpha
  double bending = 0;           ///< kappa_B
  double bending_constant = 0;  ///< p
  double global_area = 0;       ///< kappa_A
  double volume = 0;            ///< kappa_V
};

/// One limit on the shear rate: the largest value it allows (lattice units).
struct ShearRateLimit {
  std::string name;      ///< "reynolds_number_max", "mach_max", "membrane stability", "shear_modulus", ...
  double shear_rate;     ///< largest allowed
};

/// Where a scene stands against a measured stability limit (physics/stability_limits.hpp): unstable beyond `limit`.
struct StabilityMargin {
  std::string name;  ///< "membrane stiffness of red_cell", "contact stiffness", ...
  double value = 0;
  double limit = 0;
};

/// What one cell type costs and fills; filled from its mesh.
struct CellTypeLattice {
  std::string name;
  double radius = 0;            ///< nominal large radius in lattice units
  double mesh_radius = 0;       ///< large radius of the mesh: smaller by the shell with CellSize::hydrodynamic
  double shell_thickness = 0;   ///< by which the flow sees the cell larger than its mesh
  double effective_radius = 0;  ///< hydrodynamic: mesh_radius + shell_thickness
  int subdivision = 0;          ///< 0 for meshes from files
  std::int64_t vertices = 0;    ///< per cell
  std::int64_t faces = 0;
  double volume = 0;            ///< of the mesh, lattice units
  double area = 0;
  double edge = 0;              ///< mean edge of the mesh
  double squared_curvature = 0; ///< mean of (2H)^2 over the surface
  double nominal_volume = 0;    ///< of the mesh at the nominal radius; equals `volume` unless CellSize::hydrodynamic
  double counted_shell = 0;     ///< of `effective_volume`: `shell_thickness` or a thicker one
  double effective_volume = 0;  ///< with that shell (Steiner: V + A h + H h^2 + 4/3 pi h^3)
  std::int64_t count = 0;
  MembraneModuli moduli;
  double stretching_force = 0;  ///< on each of the two contact patches
};

/// Everything the solver needs, in lattice units (dx = dt = rho_0 = 1).
struct LatticeParameters {
  std::array<int, 3> nodes{};          ///< fluid nodes per direction
  /// Number of fluid nodes, which is the volume of the box.
  double box_volume() const { return double(nodes[0]) * nodes[1] * nodes[2]; }
  double radius = 0;                   ///< r
  double relaxation_time = 1;          ///< tau
  double viscosity = 0;                ///< nu = (tau - 1/2)/3 = eta_0
  double shear_rate = 0;               ///< wall shear rate for Poiseuille; 0 at rest
  double wall_velocity = 0;            ///< upper wall moves at +wall_velocity, lower at - (shear)
  double body_force = 0;               ///< force density along x (Poiseuille)
  double capillary_number = 0;         ///< with kappa_S; 0 without cells
  double reynolds_number = 0;
  double mach_number = 0;
  double phi_geometric = 0;            ///< of the meshes
  double phi_nominal = 0;              ///< of the nominal cells; equals phi_geometric unless CellSize::hydrodynamic
  double phi_effective = 0;            ///< with the shell
  double contact_strength = 0;         ///< kappa_int
  double contact_range = 0;            ///< d_0
  double membrane_time = 0;            ///< eta_0 r / kappa_S in time steps; 0 without cells
  SiUnits si;                          ///< one lattice unit in SI units
  std::int64_t steps = 0;              ///< of the whole run
  double steps_per_strain = 0;         ///< 0 at rest
  std::int64_t series_every = 0;       ///< steps
  std::int64_t snapshot_every = 0;     ///< steps; 0: none
  std::int64_t checkpoint_every = 0;   ///< steps, from the cadence by strain; 0: none
  std::int64_t guard_every = 100;      ///< steps
  int coupling_every = 1;              ///< steps; the length and the cadences above are multiples of it: nothing is measured, kept or ended between two couplings
  /// The next step at which membranes and fluid are coupled.
  std::int64_t next_coupling(std::int64_t step) const { return (step + coupling_every - 1) / coupling_every * coupling_every; }
  std::vector<CellTypeLattice> cells;
  /// Of all cells together.
  std::int64_t vertices() const {
    std::int64_t sum = 0;
    for (const auto& type : cells) sum += type.count * type.vertices;
    return sum;
  }
  std::vector<ShearRateLimit> limits;  ///< all limits, the deciding (smallest) one first
  std::vector<StabilityMargin> margins;
  std::vector<std::string> warnings;   ///< for the user: settings that are close to a stability limit, or beyond it with accuracy.allow_unstable
};

/// Chooses the largest shear rate that every limit allows and converts all quantities.
/// @throws InputError when a number can't be met (names the key, the value, the allowed range and what to do).
LatticeParameters to_lattice(const Problem& problem);

/// The relaxation time, in tenths between 1 and 2, with which the scene takes the fewest time steps. Steps per strain fall as 1/(tau - 1/2) at a fixed Reynolds number, but rise with tau
/// where the stiffness of membranes decides. A rate at which crowded cells compress the fluid by more than 5 % counts as that of 5 %: volumes of cells suffer with it. With TRT viscosity and
/// deformation don't depend on tau in this range (docs/accuracy.md). Its own relaxation time doesn't matter; 2 where the scene can't be run with any of them, or takes as many steps with all.
double relaxation_time_of_fewest_steps(Problem problem);

}  // namespace corpuscle
