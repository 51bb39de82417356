#include "io/scene_keys.hpp"

#include <algorithm>

namespace corpuscle::scene {

namespace {

// Shorthand for the accessor column of the table: P is the scene, C the cell type the key belongs to.
#define CORPUSCLE_FIELD(member) [](Problem& P, CellSpec& C) -> Field { (void)P; (void)C; return &member; }

constexpr Range any{};
constexpr Range positive(double high) { return {0, high, true, false}; }
constexpr Range between(double low, double high) { return {low, high, false, false}; }

// Upper ends of ranges that have no physical meaning only keep the arithmetic (and the memory estimate) finite.
constexpr double many_steps = 1e15;

// name | member | range | choices | unit | default when it isn't the constant of problem.hpp | meaning
const Key table[] = {
    {"box.size", CORPUSCLE_FIELD(P.box.size), positive(1e4), "", "cell radii", "",
     "Length, width and height; rounded to whole lattice nodes. x is the flow direction, z the gradient direction"},
    {"box.walls", CORPUSCLE_FIELD(P.box.walls), any, "", "", "",
     "Plane walls at both ends of z; false: periodic in z too (only `flow.kind = \"rest\"`)"},

    {"flow.kind", CORPUSCLE_FIELD(P.flow.kind), any, "shear|poiseuille|rest", "", "",
     "Moving walls, a body force along x between resting walls, or no flow"},
    {"flow.capillary_number", CORPUSCLE_FIELD(P.flow.capillary_number), positive(1e3), "", "", "one of both with cells in a flow",
     "Ca = η₀ γ̇ r / κ_S"},
    {"flow.capillary_number_G", CORPUSCLE_FIELD(P.flow.capillary_number_G), positive(3e3), "", "", "one of both with cells in a flow",
     "Ca_G = η₀ γ̇ r / G_s = 3 Ca"},
    {"flow.reynolds_number_max", CORPUSCLE_FIELD(P.flow.reynolds_number_max), positive(100), "", "", "",
     "Re = ρ γ̇ r² / η₀ does not exceed this"},

    {"cells.*.name", CORPUSCLE_FIELD(C.name), any, "", "", "the shape, numbered", "Name of the type in outputs: letters, digits, `_`, `-`"},
    {"cells.*.shape", CORPUSCLE_FIELD(C.shape), any, "red_cell|sphere|spheroid|file", "", "",
     "Reference shape; `file` follows from the key `file`"},
    {"cells.*.file", CORPUSCLE_FIELD(C.file), any, "", "", "", "Closed OFF mesh, relative to the scene; scaled so that the farthest vertex is at the radius"},
    {"cells.*.aspect_ratio", CORPUSCLE_FIELD(C.aspect_ratio), between(0.1, 10), "", "", "",
     "Spheroid only: semi-axis along the symmetry axis / equatorial radius; < 1 oblate, > 1 prolate. The larger of both is the radius"},
    {"cells.*.relative_radius", CORPUSCLE_FIELD(C.relative_radius), between(0.2, 5), "", "r", "", "Large radius of this type"},
    {"cells.*.relative_stiffness", CORPUSCLE_FIELD(C.relative_stiffness), between(0.01, 100), "", "κ_S", "", "Shear modulus of this type"},
    {"cells.*.count", CORPUSCLE_FIELD(C.count), between(1, 1e8), "", "cells", "one of three", "Number of cells"},
    {"cells.*.volume_fraction", CORPUSCLE_FIELD(C.volume_fraction), positive(0.78), "", "", "one of three", "φ = N V_cell / V_box with the volume of the mesh"},
    {"cells.*.effective_volume_fraction", CORPUSCLE_FIELD(C.effective_volume_fraction), positive(0.92), "", "", "one of three",
     "φ_eff, with a shell of `accuracy.shell_thickness` around each cell"},
    {"cells.*.position", CORPUSCLE_FIELD(C.position), between(0, 1e4), "", "cell radii", "packed", "Centre; only with `count = 1`"},
    {"cells.*.axis", CORPUSCLE_FIELD(C.axis), between(-1e6, 1e6), "", "", "[0, 0, 1]", "Direction of the symmetry axis; only with `position`"},

    {"cells.*.membrane.law", CORPUSCLE_FIELD(C.membrane.law), any, "skalak|neo_hookean", "", "", "In-plane energy"},
    {"cells.*.membrane.area_dilation", CORPUSCLE_FIELD(C.membrane.area_dilation), between(0, 1e6), "", "κ_S", "", "C = κ_α / κ_S, Skalak only"},
    {"cells.*.membrane.bending", CORPUSCLE_FIELD(C.membrane.bending), between(0, 10), "", "κ_S r²", "", "κ_B; 0: no bending force"},
    {"cells.*.membrane.bending_constant", CORPUSCLE_FIELD(C.membrane.bending_constant), positive(10), "", "", "", "p in E_B = p κ_B Σ (θ − θ₀)²"},
    {"cells.*.membrane.global_area", CORPUSCLE_FIELD(C.membrane.global_area), between(0, 1e8), "", "κ_S", "6 η₀ in lattice units; 0 for spheres and neo-Hookean membranes",
     "κ_A of the whole surface; 0: no force"},
    {"cells.*.membrane.volume", CORPUSCLE_FIELD(C.membrane.volume), between(0, 1e8), "", "κ_S / r", "c_s V₀/A in lattice units", "κ_V of the volume; 0: no force"},

    {"cells.*.stretch.force", CORPUSCLE_FIELD(C.stretch.force), between(0, 1e4), "", "κ_S r", "none",
     "External force on each cell of the type: +F along `direction` on one contact patch, −F on the opposite one"},
    {"cells.*.stretch.patch_diameter", CORPUSCLE_FIELD(C.stretch.patch_diameter), positive(10), "", "r", "",
     "Vertices of the reference shape within half of this of the two points where the line through its centroid leaves it are pulled, with equal shares"},
    {"cells.*.stretch.direction", CORPUSCLE_FIELD(C.stretch.direction), between(-1e6, 1e6), "", "", "", "Of the force, in the laboratory; constant"},

    {"contact.enabled", CORPUSCLE_FIELD(P.contact.enabled), any, "", "", "", "Repulsion between vertices of different cells, and vertices and walls"},
    {"contact.strength", CORPUSCLE_FIELD(P.contact.strength), positive(100), "", "κ_S", "", "κ_int in the force κ_int (d⁻² − d₀⁻²), d in lattice units"},
    {"contact.range", CORPUSCLE_FIELD(P.contact.range), between(0.1, 3), "", "lattice units", "", "d₀"},

    {"accuracy.preset", CORPUSCLE_FIELD(P.accuracy.preset), any, "draft|standard|reference", "", "",
     "Sets radius, delta_kernel, collision and precision; each of them given beside it wins (measured errors: docs/accuracy.md)"},
    {"accuracy.target", CORPUSCLE_FIELD(P.accuracy.target), between(0.001, 1), "", "", "none",
     "Chooses radius and delta_kernel: the cheapest measured ones whose resolution changes the viscosity by less than this part of it (docs/accuracy.md)"},
    {"accuracy.radius", CORPUSCLE_FIELD(P.accuracy.radius), between(2, 100), "", "lattice units", "preset", "r: nodes per cell radius"},
    {"accuracy.subdivision", CORPUSCLE_FIELD(P.accuracy.subdivision), between(2, 200), "", "", "nearest to the radius",
     "Frequency n of the icosahedron for relative_radius 1 (others in proportion): 20 n² faces"},
    {"accuracy.delta_kernel", CORPUSCLE_FIELD(P.accuracy.delta_kernel), between(2, 4), "", "points", "preset", "Width of the coupling kernel: 2, 3 or 4"},
    {"accuracy.collision", CORPUSCLE_FIELD(P.accuracy.collision), any, "bgk|trt", "", "preset", "Collision model"},
    {"accuracy.magic_parameter", CORPUSCLE_FIELD(P.accuracy.magic_parameter), positive(10), "", "", "", "Λ, TRT only; 3/16 puts the walls exactly half-way"},
    {"accuracy.relaxation_time", CORPUSCLE_FIELD(P.accuracy.relaxation_time), between(0.505, 5), "", "time steps", "trt: in 1 … 2, the one of fewest steps; bgk: 1", "τ; viscosity η₀ = (τ − 1/2)/3"},
    {"accuracy.precision", CORPUSCLE_FIELD(P.accuracy.precision), any, "single|double", "", "preset", "Of populations, force and velocity fields"},
    {"accuracy.membrane_precision", CORPUSCLE_FIELD(P.accuracy.membrane_precision), any, "single|double", "", "", "Of membrane forces (positions are always double)"},
    {"accuracy.vertex_update", CORPUSCLE_FIELD(P.accuracy.vertex_update), any, "averaged|chebyshev|euler", "", "", "Vertices move with a mean velocity of three steps; chebyshev: and stiff membranes relax within the step, for low Ca; euler: with the velocity of the last step"},
    {"accuracy.coupling_every", CORPUSCLE_FIELD(P.accuracy.coupling_every), between(1, 8), "", "time steps", "",
     "Membranes and fluid are coupled every so many steps; between, the fluid goes on with the forces of the last coupling. The length of the run and all cadences are rounded up to multiples of it"},
    {"accuracy.mach_max", CORPUSCLE_FIELD(P.accuracy.mach_max), positive(0.3), "", "", "", "Largest imposed velocity / speed of sound does not exceed this"},
    {"accuracy.shell_thickness", CORPUSCLE_FIELD(P.accuracy.shell_thickness), between(0, 2), "", "lattice units", "measured for the kernel",
     "By how much a cell is hydrodynamically larger than its mesh, for φ_eff and `cell_size`"},
    {"accuracy.cell_size", CORPUSCLE_FIELD(P.accuracy.cell_size), any, "mesh|hydrodynamic", "", "",
     "Which surface has the nominal radius: the mesh, or the one a shell outside of it; the mesh then lies a shell inside"},
    {"accuracy.counted_shell", CORPUSCLE_FIELD(P.accuracy.counted_shell), any, "viscosity|drag", "", "",
     "Shell of a cell in φ_eff: with that of the viscosity, suspensions have the viscosity of φ_eff whatever the resolution; that of the drag is thinner"},
    {"accuracy.shear_modulus", CORPUSCLE_FIELD(P.accuracy.shear_modulus), positive(10), "", "lattice units",
     "largest that all limits allow (rest: at most η₀/4)", "κ_S; fixes the shear rate through Ca"},
    {"accuracy.shear_rate", CORPUSCLE_FIELD(P.accuracy.shear_rate), positive(1), "", "1 / time step", "largest that all limits allow", "γ̇ (at the wall for poiseuille)"},
    {"accuracy.allow_unstable", CORPUSCLE_FIELD(P.accuracy.allow_unstable), any, "", "", "",
     "What measured stability limits refuse (docs/stability.md) is run with a warning instead"},

    {"guards.every", CORPUSCLE_FIELD(P.guards.every), between(1, 1e9), "", "time steps", "", "Checks are made this often, and with every sample; see docs/reliability.md"},
    {"guards.speed", CORPUSCLE_FIELD(P.guards.speed), positive(0.5), "", "lattice units", "", "The run is stopped when a vertex or the fluid moves faster"},
    {"guards.density", CORPUSCLE_FIELD(P.guards.density), positive(0.9), "", "", "", "… when the density of the fluid differs from 1 by more"},
    {"guards.volume_drift", CORPUSCLE_FIELD(P.guards.volume_drift), positive(10), "", "", "", "… when the volume of a cell differs from that of its reference shape by more than this part of it"},
    {"guards.area_drift", CORPUSCLE_FIELD(P.guards.area_drift), positive(100), "", "", "", "… when the area of a cell differs from that of its reference shape by more than this part of it"},
    {"guards.collapse", CORPUSCLE_FIELD(P.guards.collapse), Range{0, 1, false, true}, "", "", "", "… when triangles have less than this part of their reference area"},
    {"guards.fold", CORPUSCLE_FIELD(P.guards.fold), Range{90, 180, true, false}, "", "degrees", "", "… when the normals of neighbouring triangles are further apart; 180: never"},
    {"guards.damaged", CORPUSCLE_FIELD(P.guards.damaged), Range{0, 1, false, true}, "", "", "", "Share of a cell's triangles or edges that may be beyond `collapse` or `fold`; 0: not one"},
    {"guards.penetration", CORPUSCLE_FIELD(P.guards.penetration), positive(1), "", "contact.range", "", "… when a vertex lies deeper inside another cell"},

    {"run.strain", CORPUSCLE_FIELD(P.run.strain), positive(1e9), "", "1/γ̇", "", "Length of the run; not with `rest`"},
    {"run.duration", CORPUSCLE_FIELD(P.run.duration), positive(1e9), "", "η₀ r/κ_S", "from strain", "Length of the run instead of strain or steps: needs cells, and may be used with `rest`"},
    {"run.steps", CORPUSCLE_FIELD(P.run.steps), between(1, many_steps), "", "time steps", "from strain", "Length of the run instead of strain; `rest` needs this or `duration`"},
    {"run.seed", CORPUSCLE_FIELD(P.run.seed), between(0, 9e18), "", "", "", "Of the packing"},
    {"run.packing", CORPUSCLE_FIELD(P.run.packing), any, "", "", "", "File of a saved packing, relative to the scene; empty: pack"},
    {"run.discard", CORPUSCLE_FIELD(P.run.discard), Range{0, 1, false, true}, "", "of the run", "", "Left out of the means at the start"},

    {"output.series_every", CORPUSCLE_FIELD(P.output.series_every), positive(many_steps), "", "1/γ̇; rest: that of `steps` or `duration`", "0.05; rest: 200th of the run", "Cadence of the time series"},
    {"output.snapshot_every", CORPUSCLE_FIELD(P.output.snapshot_every), between(0, many_steps), "", "1/γ̇; rest: that of `steps` or `duration`", "1; rest: 10th of the run",
     "Cadence of the snapshots; 0: none"},
    {"output.trajectories", CORPUSCLE_FIELD(P.output.trajectories), any, "", "", "", "Data of each cell at the cadence of the series"},
    {"output.statistics", CORPUSCLE_FIELD(P.output.statistics), any, "", "", "", "statistics.json, at each checkpoint and at the end: fluctuations and diffusion of the cells, in memory that doesn't grow with the run; shear flow only"},
    {"output.fluid", CORPUSCLE_FIELD(P.output.fluid), any, "", "", "", "Velocity field at the cadence of the snapshots"},
    {"output.checkpoint_every", CORPUSCLE_FIELD(P.output.checkpoint_every), between(0, 1e6), "", "minutes of computing", "",
     "Time between checkpoints, from which `corpuscle resume` goes on; 0: only at the start, at the end and when the run is stopped"},
    {"output.checkpoint_steps", CORPUSCLE_FIELD(P.output.checkpoint_steps), between(1, many_steps), "", "time steps", "none", "A checkpoint each time that so many steps are done, too"},
    {"output.checkpoint_strain", CORPUSCLE_FIELD(P.output.checkpoint_strain), positive(many_steps), "", "1/γ̇", "none", "A checkpoint each time that so much strain is done, too; not with `rest`"},

    {"si.radius", CORPUSCLE_FIELD(P.si.radius), between(1e-9, 1e-2), "", "", "none", "Large radius r of a cell (with relative_radius = 1)"},
    {"si.viscosity", CORPUSCLE_FIELD(P.si.viscosity), between(1e-6, 1e3), "", "", "none", "Viscosity η₀ of the fluid"},
    {"si.shear_modulus", CORPUSCLE_FIELD(P.si.shear_modulus), between(1e-9, 1e3), "", "", "none", "G_s = κ_S/3, the surface shear modulus (with relative_stiffness = 1)"},
    {"si.shear_rate", CORPUSCLE_FIELD(P.si.shear_rate), positive(1e9), "", "", "none", "γ̇, instead of a capillary number; the merged scene has the capillary number"},
};
#undef CORPUSCLE_FIELD

}  // namespace

std::span<const Key> keys() { return table; }

const Key* find_key(std::string_view name) {
  const auto found = std::find_if(std::begin(table), std::end(table), [&](const Key& key) { return key.name == name; });
  return found == std::end(table) ? nullptr : &*found;
}

bool is_section(std::string_view name) {
  return std::any_of(std::begin(table), std::end(table), [&](const Key& key) { return key.section() == name; });
}

void apply_preset(AccuracySpec& accuracy, std::string_view preset) {
  accuracy.preset = preset;
  accuracy.radius = preset == "draft" ? 4 : preset == "reference" ? 12 : 8;
  // What the studies of docs/accuracy.md have on their fronts, whatever the radius.
  accuracy.delta_kernel = 2;
  accuracy.collision = CollisionKind::trt;
  accuracy.precision = Precision::single_precision;
}

bool applies(const Key& key, const Problem& problem, const CellSpec& cell, std::string& reason) {
  const auto only_if = [&](bool condition, const char* when) {
    reason = when;
    return condition;
  };
  if (key.name == "cells.*.aspect_ratio") return only_if(cell.shape == ShapeKind::spheroid, "shape = \"spheroid\"");
  if (key.name == "cells.*.file") return only_if(cell.shape == ShapeKind::file, "shape = \"file\" (or no shape)");
  if (key.name == "cells.*.membrane.area_dilation") return only_if(cell.membrane.law == StrainLawKind::skalak, "law = \"skalak\"");
  if (key.section() == "cells.*.stretch" && key.leaf() != "force") return only_if(cell.stretch.force.has_value(), "stretch.force");
  if (key.name == "accuracy.magic_parameter") return only_if(problem.accuracy.collision == CollisionKind::trt, "collision = \"trt\"");
  if (key.name == "accuracy.cell_size" && problem.accuracy.cell_size == CellSize::hydrodynamic) {
    if (problem.cells.empty()) return only_if(false, "[[cells]]");
    return only_if(problem.accuracy.shell_thickness != 0.0, "a shell (accuracy.shell_thickness > 0, or none given)");
  }
  if (key.name == "accuracy.counted_shell")
    return only_if(!problem.accuracy.shell_thickness && (problem.accuracy.cell_size == CellSize::mesh || problem.accuracy.counted_shell == CountedShell::drag),
                   "cell_size = \"mesh\", and no accuracy.shell_thickness");
  if (key.name == "run.duration" || key.section() == "si") return only_if(!problem.cells.empty(), "[[cells]]");
  if (key.name == "accuracy.shear_rate" || key.name == "output.checkpoint_strain")
    return only_if(problem.flow.kind != FlowKind::rest, "a flow (flow.kind isn't \"rest\")");
  if (key.name == "accuracy.shear_modulus" || key.name == "accuracy.coupling_every") return only_if(!problem.cells.empty(), "[[cells]]");
  if (key.section() == "guards" && key.name != "guards.every" && key.name != "guards.speed" && key.name != "guards.density") {
    if (problem.cells.empty()) return only_if(false, "[[cells]]");
    if (key.name == "guards.penetration") return only_if(problem.contact.enabled, "contact.enabled = true");
  }
  if (key.name == "run.packing") return only_if(!problem.cells.empty() || problem.run.packing.empty(), "[[cells]]");
  return true;
}

}  // namespace corpuscle::scene
