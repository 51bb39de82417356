#include "physics/model_effects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace corpuscle {
namespace {

/// One pair of runs (several seeds joined), with and without the model: absolute changes plus two standard errors.
struct Pair {
  double radius;       ///< r
  double phi_effective, capillary_number;
  double viscosity;    ///< |change of eta_r - 1| / (eta_r - 1)
  double deformation;  ///< |change of D|
};

/// A matrix of pairs: every phi with every Ca at r = 5, some again at r = 8. Numbers of docs/model_effects.json (report/model_effects.py), rounded up; at least 1e-3 and 5e-4.
struct Study {
  const char* model;
  const char* left_out_by;
  ShapeKind shape;
  bool (*used)(const Problem& problem, const CellSpec& cells);  ///< whether the scene has the model
  double share;               ///< of the time that vertices take, at phi_eff = 0.3: mean of three tables of `./dev bench models`
  std::vector<Pair> pairs;
};

bool has_bending(const Problem&, const CellSpec& cells) { return cells.membrane.bending > 0; }
bool has_contact(const Problem& problem, const CellSpec&) { return problem.contact.enabled; }
bool has_double_membrane(const Problem& problem, const CellSpec&) { return problem.accuracy.membrane_precision == Precision::double_precision; }

const std::vector<Study>& studies() {
  static const std::vector<Study> table{
      {"contact", "contact.enabled=false", ShapeKind::red_cell, has_contact, 0.09,
       {{5, 0.016, 0.01, 0.001, 0.0005},
        {5, 0.016, 0.08, 0.001, 0.0005},
        {5, 0.1, 0.01, 0.0065, 0.0005},
        {5, 0.1, 0.08, 0.001, 0.0005},
        {5, 0.2, 0.01, 0.04, 0.0095},
        {8, 0.2, 0.01, 0.045, 0.0069},
        {5, 0.2, 0.08, 0.023, 0.0027},
        {8, 0.2, 0.08, 0.016, 0.0032},
        {5, 0.3, 0.01, 0.19, 0.013},
        {5, 0.3, 0.08, 0.072, 0.0063},
        {5, 0.45, 0.01, 0.33, 0.018},
        {5, 0.45, 0.08, 0.12, 0.0049}}},
      {"bending", "cells.0.membrane.bending=0", ShapeKind::red_cell, has_bending, 0.21,
       {{5, 0.016, 0.01, 0.053, 0.019},
        {5, 0.016, 0.1, 0.16, 0.064},
        {5, 0.016, 1, 0.017, 0.013},
        {5, 0.3, 0.01, 0.12, 0.096},
        {5, 0.3, 0.1, 0.022, 0.039},
        {5, 0.3, 1, 0.0091, 0.0077},
        {8, 0.3, 1, 0.014, 0.0073}}},
      {"bending", "cells.0.membrane.bending=0", ShapeKind::sphere, has_bending, 0.21,
       {{5, 0.036, 0.01, 0.0034, 0.0029},
        {5, 0.036, 0.1, 0.0028, 0.0035},
        {5, 0.036, 1, 0.019, 0.00082},
        {5, 0.3, 0.01, 0.031, 0.0036},
        {5, 0.3, 0.1, 0.0059, 0.0022},
        {5, 0.3, 1, 0.008, 0.0018}}},
      {"membrane forces in double precision", "accuracy.membrane_precision=single", ShapeKind::red_cell, has_double_membrane, 0.08,
       {{5, 0.1, 0.01, 0.001, 0.0005},
        {5, 0.1, 0.08, 0.001, 0.0005},
        {5, 0.3, 0.01, 0.001, 0.0005},
        {5, 0.3, 0.08, 0.001, 0.0005},
        {8, 0.3, 0.08, 0.001, 0.0005},
        {5, 0.45, 0.01, 0.001, 0.0005},
        {5, 0.45, 0.08, 0.001, 0.0005}}},
  };
  return table;
}

/// Whether a scene is like those of the pairs in everything but phi_eff, Ca and resolution.
bool is_like_the_studies(const Problem& problem) {
  if (problem.flow.kind != FlowKind::shear || !problem.box.walls || problem.cells.size() != 1) return false;
  const CellSpec &cells = problem.cells[0], usual;
  const ContactSpec contact;
  const AccuracySpec& accuracy = problem.accuracy;
  return cells.membrane.law == usual.membrane.law && cells.membrane.area_dilation == usual.membrane.area_dilation && cells.membrane.bending <= usual.membrane.bending &&
         !cells.membrane.global_area && !cells.membrane.volume && cells.relative_radius == 1 && !cells.stretch.force && problem.contact.strength <= contact.strength &&
         problem.contact.range <= contact.range && accuracy.delta_kernel == 2 && accuracy.vertex_update == VertexUpdate::averaged && accuracy.collision == CollisionKind::trt &&
         accuracy.relaxation_time >= 1 && accuracy.relaxation_time <= 2;
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
  if (!is_like_the_studies(problem)) return found;
  const CellSpec& cells = problem.cells[0];
  for (const Study& study : studies()) {
    if (cells.shape != study.shape || !study.used(problem, cells)) continue;
    const auto phi = surrounding(study.pairs, [](const Pair& p) { return p.phi_effective; }, lattice.phi_effective, 0.05);
    const auto ca = surrounding(study.pairs, [](const Pair& p) { return p.capillary_number; }, lattice.capillary_number, 0.02);
    const auto radius = surrounding(study.pairs, [](const Pair& p) { return p.radius; }, lattice.radius, 0.02);
    if (!phi || !ca || !radius) continue;
    DispensableModel model{study.model, study.left_out_by, 0, 0, study.share * vertex_share, ""};
    const auto between = [](double x, const Bounds& b) { return x >= b.low && x <= b.high; };
    bool finer = false;
    for (const Pair& pair : study.pairs)
      if (between(pair.phi_effective, *phi) && between(pair.capillary_number, *ca)) {
        model.viscosity_change = std::max(model.viscosity_change, pair.viscosity);
        model.deformation_change = std::max(model.deformation_change, pair.deformation);
        finer = finer || pair.radius > 5;
      }
    if (model.viscosity_change > negligible_viscosity_change || model.deformation_change > negligible_deformation_change) continue;
    const char* shapes = study.shape == ShapeKind::red_cell ? "red cells" : "spheres";
    model.measured = fmt::format("{}, phi_eff = {}, Ca = {}, r = 5{}", shapes, range_text(*phi), range_text(*ca), finer ? " and 8" : "");
    found.push_back(std::move(model));
  }
  return found;
}

}  // namespace corpuscle
