// What a scene asks for, in dimensionless numbers. Each struct mirrors one table of the scene file (docs/scene.md);
// io/scene fills and validates it, physics/units turns it into lattice parameters. No Kokkos here.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace corpuscle {

enum class FlowKind { shear, poiseuille, rest };
enum class ShapeKind { red_cell, sphere, spheroid, file };
enum class StrainLawKind { skalak, neo_hookean };
enum class CollisionKind { bgk, trt };
/// How vertices move with the interpolated velocity (physics/vertex_motion.hpp).
enum class VertexUpdate { averaged, chebyshev, euler };
/// Which surface has the nominal radius: the mesh, or the one a hydrodynamic shell outside of it (physics/hydrodynamic_size.hpp).
enum class CellSize { mesh, hydrodynamic };
/// The shell of a cell in phi_effective: the one with which viscosities do not depend on the resolution, or that of the drag (physics/hydrodynamic_size.hpp).
enum class CountedShell { viscosity, drag };
enum class Precision { single_precision, double_precision };

/// [si] What the dimensionless scene stands for. Values that a scene gives with units ("67.7 pN") are converted with these when it is read; nothing else
/// depends on them, and outputs state the units that follow (physics/si_units.hpp).
struct SiSpec {
  std::optional<double> radius;         ///< r in m
  std::optional<double> viscosity;      ///< eta_0 in Pa s
  std::optional<double> shear_modulus;  ///< G_s = kappa_S / 3 in N/m, of cell types with relative_stiffness 1
  std::optional<double> shear_rate;     ///< in 1/s; reading turns it into flow.capillary_number
};

/// [box] Lengths in cell radii; z is the gradient direction and is bounded by walls when `walls` is true, x is the flow direction.
struct BoxSpec {
  std::array<double, 3> size{20, 20, 40};
  bool walls = true;
};

/// [flow]
struct FlowSpec {
  FlowKind kind = FlowKind::shear;
  std::optional<double> capillary_number;    ///< Ca = eta_0 shear_rate r / kappa_S (Krueger's convention)
  std::optional<double> capillary_number_G;  ///< Ca_G = eta_0 shear_rate r / G_s = 3 Ca; one of both, none without cells
  double reynolds_number_max = 0.1;          ///< Re = rho shear_rate r^2 / eta_0 must not exceed this
};

/// [[cells]].membrane: elastic moduli relative to kappa_S of the cell type (docs/theory/model.md, Membrane).
struct MembraneSpec {
  StrainLawKind law = StrainLawKind::skalak;
  double area_dilation = 2.5;                ///< C = kappa_alpha / kappa_S (Skalak only)
  double bending = 1.0 / 405.0;              ///< kappa_B / (kappa_S r^2); 0: no bending
  double bending_constant = 0.8660254037844386;  ///< p in E_B = p kappa_B sum (theta - theta_0)^2
  std::optional<double> global_area;         ///< kappa_A / kappa_S; absent: 6 eta_0 (1 at tau = 1), but 0 for spheres and neo-Hookean
  std::optional<double> volume;              ///< kappa_V r / kappa_S; absent: c_s V_0/A in lattice units; 0: no volume force
};

/// [[cells]].stretch: two opposite external forces on two contact patches (physics/stretching.hpp).
struct StretchSpec {
  std::optional<double> force;               ///< F / (kappa_S r) of the type: +F on one patch, -F on the other; absent: none
  double patch_diameter = 0.5;               ///< in radii of the type
  std::array<double, 3> direction{1, 0, 0};  ///< of +F, in the laboratory; the patches lie where it leaves the cell as placed by `axis`
};

/// [[cells]] one cell type.
struct CellSpec {
  std::string name;                          ///< used in outputs; default: shape name, numbered when not unique
  ShapeKind shape = ShapeKind::red_cell;
  std::string file;                          ///< OFF mesh for ShapeKind::file (path relative to the scene)
  double aspect_ratio = 0.5;                 ///< spheroid: semi-axis along its symmetry axis / r (oblate < 1 < prolate)
  double relative_radius = 1.0;              ///< large radius / r
  double relative_stiffness = 1.0;           ///< kappa_S of this type / kappa_S of the scene
  std::optional<std::int64_t> count;         ///< exactly one of count, volume_fraction, effective_volume_fraction
  std::optional<double> volume_fraction;     ///< N V_cell / V_box with the mesh volume
  std::optional<double> effective_volume_fraction;  ///< with the volume that includes the hydrodynamic shell
  std::optional<std::array<double, 3>> position;    ///< of the only cell of the type, in cell radii; else packed
  std::optional<std::array<double, 3>> axis;        ///< symmetry axis of the only cell (reference: z); with `position`
  MembraneSpec membrane;
  StretchSpec stretch;
};

/// [contact] short-range repulsion between vertices of different cells, and vertices and walls.
struct ContactSpec {
  bool enabled = true;
  double strength = 1.0;                     ///< kappa_int / kappa_S (lattice units)
  double range = 1.0;                        ///< d_0 in lattice units
};

/// [accuracy] the knobs that trade speed for error.
struct AccuracySpec {
  std::string preset = "standard";           ///< draft | standard | reference
  std::optional<double> target;              ///< error of the viscosity that radius and kernel are chosen for; not set once they are (physics/resolution_choice.hpp)
  double radius = 8;                         ///< r in lattice units
  std::optional<int> subdivision;            ///< frequency n of the geodesic icosahedron; default: nearest to the radius
  int delta_kernel = 2;                      ///< 2 | 3 | 4 points
  CollisionKind collision = CollisionKind::trt;
  double magic_parameter = 3.0 / 16.0;       ///< Lambda of TRT
  double relaxation_time = 1.0;              ///< tau; viscosity = (tau - 1/2)/3. A scene that gives none with TRT gets relaxation_time_of_fewest_steps()
  Precision precision = Precision::single_precision;            ///< populations, force and velocity fields
  Precision membrane_precision = Precision::double_precision;   ///< membrane forces (positions are always double)
  VertexUpdate vertex_update = VertexUpdate::averaged;
  int coupling_every = 1;                    ///< time steps of the fluid for each coupling to the membranes (physics/suspension.hpp)
  double mach_max = 0.1;                     ///< wall (or maximum) velocity / speed of sound must not exceed this
  std::optional<double> shell_thickness;     ///< hydrodynamic shell around a mesh, lattice units; default: the measured one of the kernel
  CellSize cell_size = CellSize::mesh;
  CountedShell counted_shell = CountedShell::viscosity;         ///< of cells whose meshes have the nominal size
  std::optional<double> shear_modulus;       ///< kappa_S in lattice units; default: the largest stable one
  std::optional<double> shear_rate;          ///< in lattice units; default: the largest that all limits allow
  bool allow_unstable = false;               ///< what measured stability limits refuse is run with a warning
};

/// [guards] when a run is stopped (physics/guards.hpp, docs/reliability.md).
struct GuardSpec {
  int every = 100;                           ///< time steps between checks
  double speed = 0.3;                        ///< of vertices and fluid, lattice units
  double density = 0.2;                      ///< |rho - 1|
  double volume_drift = 0.1;                 ///< |V/V_0 - 1| of a cell
  double area_drift = 3;                     ///< |A/A_0 - 1| of a cell
  double collapse = 1e-3;                    ///< smallest area of a triangle / its reference area
  double fold = 175;                         ///< degrees between the normals of two triangles at an edge
  double damaged = 0.01;                     ///< share of a cell's triangles or edges that may be beyond `collapse` or `fold`
  double penetration = 0.6;                  ///< depth of a vertex below the surface of another cell, in contact.range
};

/// [run]
struct RunSpec {
  double strain = 10;                        ///< length of the run in units of 1/shear_rate (rest: ignored)
  std::optional<std::int64_t> steps;         ///< length in time steps instead
  std::optional<double> duration;            ///< length in units of eta_0 r / kappa_S instead; rest: one of both is needed
  std::uint64_t seed = 1;
  std::string packing;                       ///< file of a saved packing to start from; empty: pack
  double discard = 0.25;                     ///< fraction of the run left out of the means
};

/// [output] cadences in strain units (rest: in the unit of the length of the run, steps or eta_0 r / kappa_S).
struct OutputSpec {
  double series_every = 0.05;
  double snapshot_every = 1.0;               ///< 0: none
  bool trajectories = true;                  ///< per-cell data at the cadence of the series
  bool statistics = false;                   ///< fluctuations and diffusion of the cells while the run goes on (physics/live_statistics.hpp)
  bool fluid = false;                        ///< velocity field as ImageData at the cadence of the snapshots
  double checkpoint_every = 10;              ///< minutes of wall time between checkpoints; 0: none by time
  std::optional<std::int64_t> checkpoint_steps;  ///< and after this many time steps
  std::optional<double> checkpoint_strain;   ///< and after this much strain
};

/// A complete scene.
struct Problem {
  SiSpec si;
  BoxSpec box;
  FlowSpec flow;
  std::vector<CellSpec> cells;
  ContactSpec contact;
  AccuracySpec accuracy;
  GuardSpec guards;
  RunSpec run;
  OutputSpec output;
};

}  // namespace corpuscle
