#include "physics/model_effects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace corpuscle {
namespace {

/// One pair of runs (several seeds joined), with and without the model: absolute changes plus two standard errors.
struct Pair {
  double phi_effective, capillary_number;
  double viscosity;    ///< |change of eta_r - 1| / (eta_r - 1)
  double deformation;  ///< |change of D|
};

/// A matrix of pairs: every phi with every Ca. Numbers of docs/model_effects.json (report/model_effects.py), rounded up.
struct Study {
  const char* model;
  const char* left_out_by;
  ShapeKind shape;
  bool (*used)(const Problem& problem, const CellSpec& cells);  ///< whether the scene has the model, no stronger than measured
  double share;               ///< of the time that vertices take, at phi_eff = 0.3: the table of `./dev bench models` in docs/models.md
  std::vector<Pair> pairs;
};

bool has_bending(const Problem&, const CellSpec& cells) { return cells.membrane.bending > 0; }
bool has_contact(const Problem& problem, const CellSpec&) { return problem.contact.enabled; }
bool has_double_membrane(const Problem& problem, const CellSpec&) { return problem.accuracy.membrane_precision == Precision::double_precision; }

const std::vector<Study>& studies() {
  static const std::vector<Study> table{
@@TABLE@@
  };
  return table;
}

/// Whether a scene is like those of the pairs in everything but phi_eff and Ca. The standard resolution was compared at one point of each study.
bool is_like_the_studies(const Problem& problem, const LatticeParameters& lattice) {
  if (problem.flow.kind != FlowKind::shear || !problem.box.walls || problem.cells.size() != 1) return false;
  const CellSpec &cells = problem.cells[0], usual;
  const ContactSpec contact;
  const AccuracySpec& accuracy = problem.accuracy;
  return cells.membrane.law == usual.membrane.law && cells.membrane.area_dilation == usual.membrane.area_dilation && cells.membrane.bending <= usual.membrane.bending &&
         !cells.membrane.global_area && !cells.membrane.volume && cells.relative_radius == 1 && !cells.stretch.force && problem.contact.strength <= contact.strength &&
         problem.contact.range <= contact.range && accuracy.delta_kernel == 3 && accuracy.vertex_update == VertexUpdate::averaged && accuracy.relaxation_time == 1 &&
         lattice.radius >= 5 && lattice.radius <= 8;
}

struct Bounds {
  double low, high;
};

/// The measured values next to x; none outside of them. `slack`: whole cells never give exactly the fraction of a study.
template <class Value>
std::optional<Bounds> surrounding(const std::vector<Pair>& pairs, const Value& value, double x, double slack) {
  Bounds bounds{-1, -1};
  for (const Pair& pair : pairs) {
    const double at = value(pair);
    if (at <= x * (1 + slack) && at > bounds.low) bounds.low = at;
    if (at >= x * (1 - slack) && (bounds.high < 0 || at < bounds.high)) bounds.high = at;
  }
  if (bounds.low < 0 || bounds.high < 0) return {};
  return bounds;
}

std::string range_text(const Bounds& b) { return b.low == b.high ? fmt::format("{:g}", b.low) : fmt::format("{:g} to {:g}", b.low, b.high); }

}  // namespace

std::vector<DispensableModel> dispensable_models(const Problem& problem, const LatticeParameters& lattice, double vertex_share) {
  std::vector<DispensableModel> found;
  if (!is_like_the_studies(problem, lattice)) return found;
  const CellSpec& cells = problem.cells[0];
  for (const Study& study : studies()) {
    if (cells.shape != study.shape || !study.used(problem, cells)) continue;
    const auto phi = surrounding(study.pairs, [](const Pair& p) { return p.phi_effective; }, lattice.phi_effective, 0.05);
    const auto ca = surrounding(study.pairs, [](const Pair& p) { return p.capillary_number; }, lattice.capillary_number, 0.02);
    if (!phi || !ca) continue;
    DispensableModel model{study.model, study.left_out_by, 0, 0, study.share * vertex_share, ""};
    const auto between = [](double x, const Bounds& b) { return x >= b.low && x <= b.high; };
    for (const Pair& pair : study.pairs)
      if (between(pair.phi_effective, *phi) && between(pair.capillary_number, *ca)) {
        model.viscosity_change = std::max(model.viscosity_change, pair.viscosity);
        model.deformation_change = std::max(model.deformation_change, pair.deformation);
      }
    if (model.viscosity_change > negligible_viscosity_change || model.deformation_change > negligible_deformation_change) continue;
    model.measured = fmt::format("{}, phi_eff = {}, Ca = {}", study.shape == ShapeKind::red_cell ? "red cells" : "spheres", range_text(*phi), range_text(*ca));
    found.push_back(std::move(model));
  }
  return found;
}

}  // namespace corpuscle
