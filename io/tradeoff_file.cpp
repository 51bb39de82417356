// tradeoff.json, .csv and .md.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/version.hpp"
#include "io/analysis_file.hpp"
#include "io/tradeoff.hpp"

namespace corpuscle {
namespace {

using Json = nlohmann::ordered_json;
using statistics::Estimate;

Json estimate(const Estimate& e) { return {{"value", json_number(e.value)}, {"error", json_number(e.error)}, {"converged", e.converged}, {"reason", e.reason}}; }
std::string cell(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : ""; }
std::string percent(const Estimate& d) { return std::isnan(d.value) ? "-" : with_error(100 * d.value, 100 * d.error) + " %"; }
std::string digits(double value, int count = 3) { return std::isfinite(value) ? fmt::format("{:.{}g}", value, count) : "-"; }

Json settings_of(const Study& study, const std::vector<std::string>& settings) {
  Json json = Json::object();
  for (std::size_t k = 0; k < study.knobs.size(); ++k)
    if (!settings[k].empty()) json[study.knobs[k]] = settings[k];
  return json;
}

std::string others_text(const Study& study, const std::vector<std::string>& settings) {
  std::string text;
  for (std::size_t k = 0; k < study.knobs.size(); ++k)
    if (!settings[k].empty() && settings[k] != study.base_settings[k]) text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", study.knobs[k], settings[k]);
  return text.empty() ? "as the base scene" : text;
}

bool on_front(const StudyResult& result, std::size_t i) { return std::find(result.front.begin(), result.front.end(), i) != result.front.end(); }

std::string front_page(const StudyResult& result) {
  const Study& study = result.study;
  std::string page = "\n## The front\n\nNo cheaper point is as accurate. The deviation is that of the observable that deviates most.\n\n|";
  for (const auto& knob : study.knobs) page += fmt::format(" {} |", knob);
  page += " core s/strain | deviation | of | what limits it |\n|";
  for (std::size_t k = 0; k < study.knobs.size() + 4; ++k) page += "---|";
  page += "\n";
  for (const std::size_t i : result.front) {
    page += "|";
    for (const auto& setting : result.points[i].settings) page += fmt::format(" {} |", setting);
    const auto& d = result.deviations[i];
    std::string limit = "nothing that was tried, beyond the uncertainty";
    for (const auto& l : result.limiting)
      if (l.point == i) limit = fmt::format("{} → {}: {:.1f} % at {} times the cost", study.knobs[l.knob], l.to, 100 * l.error, digits(l.cost_factor));
    page += fmt::format(" {} | {} | {} | {} |\n", digits(result.points[i].cost), percent(d.of[d.worst]), study.observables[d.worst], limit);
  }
  return page;
}

/// The extrapolations that the reference is the mean of.
std::string families_page(const StudyResult& result) {
  if (result.limits.empty()) return "";
  const Study& study = result.study;
  std::string page = fmt::format("\n## Extrapolation\n\nvalue = limit + a/{0} + b/{0}², by family; the error has the statistical part, the change of the limit without the coarsest resolution, and a part of the way to it from the finest one.\n\n|", study.reference.extrapolate);
  page += " settings | observable | from | limit | a | b |\n|---|---|---|---|---|---|\n";
  for (std::size_t o = 0; o < result.limits.size(); ++o)
    for (std::size_t f = 0; f < result.families.size(); ++f) {
      const auto& family = result.limits[o].families[f];
      if (std::isnan(family.limit.value)) continue;
      page += fmt::format("| {} | {} | {} | {} | {} | {} |\n", others_text(study, result.families[f]), study.observables[o], digits(family.from), with_error(family.limit.value, family.limit.error),
                          digits(family.first), digits(family.second));
    }
  return page;
}

std::string fraction_text(const Study& study) {
  if (!study.fraction || study.fraction->exponents.empty()) return "";
  std::string text;
  for (const auto& [observable, exponent] : study.fraction->exponents) text += fmt::format("{}{} ∝ φ^{:g}", text.empty() ? "" : ", ", observable, exponent);
  return fmt::format("Taken to φ = {:g} with {} (a viscosity without its 1). ", study.fraction->phi, text);
}

std::string points_page(const StudyResult& result) {
  const Study& study = result.study;
  std::string page = "\n## All points\n\n" + fraction_text(study) + "Each observable with its deviation from the reference. A star marks what is not converged, **bold** what is on the front.\n\n|";
  for (const auto& knob : study.knobs) page += fmt::format(" {} |", knob);
  page += " steps/strain | core s/strain | measured |";
  for (const auto& name : study.observables) page += fmt::format(" {} | deviation |", name);
  page += "\n|";
  for (std::size_t k = 0; k < study.knobs.size() + 3 + 2 * study.observables.size(); ++k) page += "---|";
  page += "\n";
  for (std::size_t i = 0; i < result.entries.size(); ++i) {
    const StudyEntry& entry = result.entries[i];
    const std::string bold = on_front(result, i) ? "**" : "";
    page += "|";
    for (const auto& setting : entry.point.settings) page += fmt::format(" {}{}{} |", bold, setting, bold);
    if (entry.state != "finished") {
      page += fmt::format(" {} | | |", entry.state);
      for (std::size_t o = 0; o < study.observables.size(); ++o) page += " - | - |";
    } else {
      page += fmt::format(" {:.0f} | {} | {} |", entry.steps_per_strain, digits(entry.point.cost), digits(entry.measured));
      for (std::size_t o = 0; o < study.observables.size(); ++o) {
        const Estimate& e = entry.point.observed[o];
        page += fmt::format(" {}{} | {} |", with_error(e.value, e.error), e.converged || std::isnan(e.value) ? "" : " *", percent(result.deviations[i].of[o]));
      }
    }
    page += "\n";
  }
  return page;
}

std::string knobs_page(const StudyResult& result) {
  const Study& study = result.study;
  std::string page;
  if (!result.steps.empty()) {
    page += "\n## What each knob buys\n\nMedians over all pairs of points that differ in this step only.\n\n| knob | step | pairs | cost | deviation |\n|---|---|---|---|---|\n";
    for (const auto& s : result.steps)
      page += fmt::format("| {} | {} → {} | {} | × {} | × {} |\n", study.knobs[s.knob], s.from, s.to, s.pairs, digits(s.cost_factor), digits(s.error_factor));
  }
  if (!result.orders.empty()) {
    page += "\n## Convergence\n\n|deviation| = prefactor × setting^−order, from the points that deviate by more than their uncertainty.\n\n"
            "| knob | other settings | observable | points | order |\n|---|---|---|---|---|\n";
    for (const auto& o : result.orders) {
      const Estimate exponent = o.fit.parameter("exponent");
      page += fmt::format("| {} | {} | {} | {} | {}{} |\n", study.knobs[o.knob], others_text(study, o.others), study.observables[o.observable], o.points,
                          with_error(-exponent.value, exponent.error), o.fit.converged ? "" : fmt::format(" ({})", o.fit.reason));
    }
  }
  return page;
}

}  // namespace

Json tradeoff_json(const StudyResult& result) {
  const Study& study = result.study;
  Json json = {{"format", tradeoff_format}, {"version", version_string()}, {"git_revision", git_revision()}, {"machine", result.machine}, {"scene", study.sweep.scene.substr(study.sweep.scene.rfind('/') + 1)}, {"observables", study.observables}};
  json["knobs"] = study.knobs;
  json["base"] = settings_of(study, study.base_settings);
  if (study.fraction) json["fraction"] = {{"phi", study.fraction->phi}, {"exponents", study.fraction->exponents}};
  for (std::size_t o = 0; o < study.observables.size(); ++o) {
    Json& r = json["reference"][study.observables[o]] = estimate(result.reference.values[o]);
    r["from"] = result.reference_from[o];
    if (result.limits.empty()) continue;
    const auto& limit = result.limits[o];
    r["chi2"] = json_number(limit.chi2);
    r["degrees_of_freedom"] = limit.degrees_of_freedom;
    for (std::size_t f = 0; f < result.families.size(); ++f) {
      const auto& family = limit.families[f];
      r["families"].push_back({{"settings", settings_of(study, result.families[f])}, {"limit", json_number(family.limit.value)}, {"error", json_number(family.limit.error)}, {"from_resolution", json_number(family.from)},
                               {"first", json_number(family.first)}, {"second", json_number(family.second)}, {"statistical_error", json_number(family.statistical_error)}, {"model_error", json_number(family.model_error)}});
    }
  }
  json["points"] = Json::array();
  for (std::size_t i = 0; i < result.entries.size(); ++i) {
    const StudyEntry& entry = result.entries[i];
    Json point = {{"name", entry.point.name}, {"settings", settings_of(study, entry.point.settings)}, {"state", entry.state}, {"message", entry.message}, {"runs", entry.runs}};
    point["nodes"] = json_number(entry.nodes);
    point["vertices"] = json_number(entry.vertices);
    point["steps_per_strain"] = json_number(entry.steps_per_strain);
    point["core_seconds_per_strain"] = {{"predicted", json_number(entry.point.cost)}, {"measured", json_number(entry.measured)}};
    for (std::size_t o = 0; o < study.observables.size(); ++o) {
      Json& observed = point["observed"][study.observables[o]] = estimate(entry.point.observed[o]);
      const Estimate& d = result.deviations[i].of[o];
      observed["deviation"] = {{"value", json_number(d.value)}, {"error", json_number(d.error)}};
    }
    point["deviation"] = {{"value", json_number(result.deviations[i].size)}, {"error", json_number(result.deviations[i].uncertainty)}, {"of", study.observables[result.deviations[i].worst]}};
    point["on_front"] = on_front(result, i);
    json["points"].push_back(point);
  }
  json["front"] = json["limiting_knobs"] = json["knob_steps"] = json["orders"] = Json::array();
  for (const std::size_t i : result.front) json["front"].push_back(result.points[i].name);
  for (const auto& l : result.limiting)
    json["limiting_knobs"].push_back({{"point", result.points[l.point].name}, {"knob", study.knobs[l.knob]}, {"to", l.to}, {"deviation", json_number(l.error)}, {"cost_factor", json_number(l.cost_factor)}});
  for (const auto& s : result.steps)
    json["knob_steps"].push_back({{"knob", study.knobs[s.knob]}, {"from", s.from}, {"to", s.to}, {"pairs", s.pairs}, {"cost_factor", json_number(s.cost_factor)}, {"deviation_factor", json_number(s.error_factor)}});
  for (const auto& o : result.orders) {
    const Estimate exponent = o.fit.parameter("exponent");
    json["orders"].push_back({{"knob", study.knobs[o.knob]}, {"observable", study.observables[o.observable]}, {"others", settings_of(study, o.others)}, {"points", o.points},
                              {"order", json_number(-exponent.value)}, {"error", json_number(exponent.error)}, {"converged", o.fit.converged}});
  }
  json["warnings"] = result.warnings;
  return json;
}

std::string tradeoff_csv(const StudyResult& result) {
  const Study& study = result.study;
  std::string text = "name";
  for (const auto& knob : study.knobs) text += "," + knob;
  text += ",state,nodes,vertices,steps_per_strain,core_seconds_per_strain,core_seconds_per_strain_measured";
  for (const auto& name : study.observables) text += fmt::format(",{0},{0}_error,{0}_deviation,{0}_deviation_error", name);
  text += ",on_front";
  for (std::size_t i = 0; i < result.entries.size(); ++i) {
    const StudyEntry& entry = result.entries[i];
    text += "\n" + entry.point.name;
    for (const auto& setting : entry.point.settings) text += "," + csv_field(setting);
    text += fmt::format(",{}", entry.state);
    for (const double value : {entry.nodes, entry.vertices, entry.steps_per_strain, entry.point.cost, entry.measured}) text += "," + cell(value);
    for (std::size_t o = 0; o < study.observables.size(); ++o) {
      const Estimate &e = entry.point.observed[o], &d = result.deviations[i].of[o];
      for (const double value : {e.value, e.error, d.value, d.error}) text += "," + cell(value);
    }
    text += on_front(result, i) ? ",1" : ",0";
  }
  return text + "\n";
}

std::string tradeoff_page(const StudyResult& result) {
  const Study& study = result.study;
  std::string page = fmt::format("# Error against cost\n\nBase scene: {}. Cost: core seconds a unit of strain, predicted for one thread of {} from counted work; \"measured\": what the runs took.\n\n"
                                 "| observable | reference | from |\n|---|---|---|\n", study.sweep.scene.substr(study.sweep.scene.rfind('/') + 1), result.machine);
  for (std::size_t o = 0; o < study.observables.size(); ++o) {
    const Estimate& r = result.reference.values[o];
    page += fmt::format("| {} | {}{} | {} |\n", study.observables[o], with_error(r.value, r.error), r.converged || std::isnan(r.value) ? "" : " *", result.reference_from[o]);
  }
  page += front_page(result);
  page += knobs_page(result);
  page += families_page(result);
  page += points_page(result);
  return page + warnings_page(result.warnings);
}

}  // namespace corpuscle
