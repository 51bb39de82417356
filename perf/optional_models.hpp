// The models that a scene may leave out, each as a pair of scenes: the table behind docs/models.md (bench_models) and behind the test that a model left out costs nothing.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "io/scene.hpp"

namespace corpuscle::perf {

struct OptionalModel {
  std::string name;
  std::string left_out_by;                     ///< what a scene says
  std::vector<std::string> kernels;            ///< beginnings of the labels of kernels that only this model launches; ", term": a term in the label of the membranes' kernel
  std::vector<std::string> arrays;             ///< beginnings of the labels of arrays that only this model allocates
  std::vector<std::string> shared;             ///< kernels of others that it makes run more or less often
  std::function<void(Problem&)> with, without; ///< change the scene with all usual models
};

/// Red cells between sheared walls with all usual models, `size` radii wide, r = `radius` lattice units.
inline Problem usual_scene(double size, double radius, double phi_effective) {
  const std::string wide = std::to_string(size);
  const std::string text = "[box]\nsize = [" + wide + ", " + wide + ", " + wide + "]\n[flow]\ncapillary_number = 0.1\n[run]\nstrain = 1\n[accuracy]\nallow_unstable = true\ncounted_shell = \"drag\"\n" +
                           "radius = " + std::to_string(radius) + "\n[[cells]]\neffective_volume_fraction = " + std::to_string(phi_effective) + "\n";
  return parse_scene(text, "usual scene");
}

inline void remove_cells(Problem& p) {
  p.cells.clear();
  p.flow.capillary_number.reset();
}

inline void rest_without_cells(Problem& p) {
  remove_cells(p);
  p.flow.kind = FlowKind::rest;
  p.run.steps = 10;
}

inline std::vector<OptionalModel> optional_models() {
  const auto as_is = [](Problem&) {};
  const auto membrane = [](auto change) { return [change](Problem& p) { change(p.cells[0].membrane); }; };
  return {
      {"cells", "no `[[cells]]`",
       {"membrane_forces", "contact", "bin_", "spread", "sort_", "scatter_force", "gather_velocity", "interpolate", "advance"},
       {"positions", "velocities", "forces", "force", "velocity", "previous_velocities", "membrane_", "faces", "cell_values", "contact", "bin_",
        "sort_", "spread_", "guard_type", "guard_f", "guard_e", "guard_r", "guard_c", "guard_s"},
       {}, as_is, remove_cells},
      {"walls (fluid alone)", "`box.walls = false`", {"bounce_back"}, {}, {"exchange_populations"}, rest_without_cells, [](Problem& p) { rest_without_cells(p); p.box.walls = false; }},
      {"body force (fluid alone)", "`flow.kind`", {}, {}, {}, [](Problem& p) { remove_cells(p); p.flow.kind = FlowKind::poiseuille; }, rest_without_cells},
      {"Skalak's law for neo-Hookean", "`law = \"neo_hookean\"`", {}, {}, {}, as_is, membrane([](MembraneSpec& m) { m.law = StrainLawKind::neo_hookean, m.global_area = 25; })},
      {"bending", "`bending = 0`", {", bending"}, {"membrane_edge"}, {}, as_is, membrane([](MembraneSpec& m) { m.bending = 0; })},
      {"global area", "`global_area = 0`", {", area"}, {}, {}, as_is, membrane([](MembraneSpec& m) { m.global_area = 0; })},
      {"volume", "`volume = 0`", {", volume"}, {}, {}, as_is, membrane([](MembraneSpec& m) { m.volume = 0; })},
      {"membrane in double precision", "`membrane_precision = \"single\"`", {}, {}, {}, as_is, [](Problem& p) { p.accuracy.membrane_precision = Precision::single_precision; }},
      {"contact", "`contact.enabled = false`", {"contact", "bin_"}, {"contact", "bin_"}, {}, as_is, [](Problem& p) { p.contact.enabled = false; }},
      {"stretching", "no `stretch`", {"stretching_forces"}, {"stretch"}, {}, [](Problem& p) { p.cells[0].stretch.force = 0.01; }, as_is},
      {"averaged vertex update", "`vertex_update = \"euler\"`", {}, {"previous_velocities", "velocities_before"}, {}, as_is,
       [](Problem& p) { p.accuracy.vertex_update = VertexUpdate::euler; }},
      {"chebyshev vertex update", "`vertex_update = \"averaged\"`", {"chebyshev", "mobility_", "smooth_forces", "vertex_motion"}, {"chebyshev", "mobility_"},
       {"membrane_forces", "contact_forces"}, [](Problem& p) { p.accuracy.vertex_update = VertexUpdate::chebyshev; }, as_is},
  };
}

/// Whether a label begins with one of these.
inline bool begins_with_any(const std::string& label, const std::vector<std::string>& beginnings) {
  for (const auto& beginning : beginnings)
    if (label.rfind(beginning, 0) == 0) return true;
  return false;
}

}  // namespace corpuscle::perf
