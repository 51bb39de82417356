#include "io/tradeoff.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace corpuscle {
namespace {

using statistics::Estimate;

std::size_t index_of(const std::vector<std::string>& list, const std::string& name) { return static_cast<std::size_t>(std::find(list.begin(), list.end(), name) - list.begin()); }

/// The limit along one knob. Points count where all knobs that change the limit have the settings of the base scene.
void extrapolate(StudyResult& result) {
  const Study& study = result.study;
  const std::size_t along = index_of(study.knobs, study.reference.extrapolate);
  const auto takes_part = [&](const tradeoff::Point& p) {
    for (std::size_t k = 0; k < study.knobs.size(); ++k) {
      const bool free = k == along || index_of(study.reference.same_limit, study.knobs[k]) < study.reference.same_limit.size();
      if (!free && p.settings[k] != study.base_settings[k]) return false;
    }
    return true;
  };
  std::vector<std::vector<statistics::ResolvedValue>> values(study.observables.size());
  for (const auto& p : result.points) {
    if (!takes_part(p)) continue;
    std::vector<std::string> family = p.settings;
    family[along].clear();
    auto found = std::find(result.families.begin(), result.families.end(), family);
    if (found == result.families.end()) found = result.families.insert(result.families.end(), family);
    const int number = static_cast<int>(found - result.families.begin());
    for (std::size_t o = 0; o < study.observables.size(); ++o) {
      const Estimate& e = p.observed[o];
      values[o].push_back({tradeoff::number_of(p.settings[along]), number, e.value, e.error});  // one without an error is left out
    }
  }
  for (std::size_t o = 0; o < study.observables.size(); ++o) {
    result.limits.push_back(statistics::common_limit(values[o]));
    result.limits.back().families.resize(result.families.size());
    result.reference.values.push_back(result.limits.back().limit);
    result.reference_from.push_back(fmt::format("limit of {} families of settings for {} → infinity", static_cast<int>(result.limits.back().limit.effective_samples), study.reference.extrapolate));
  }
}

/// The point whose settings are those that the reference names, and of the base scene otherwise.
void take_point(StudyResult& result) {
  const Study& study = result.study;
  std::vector<std::string> wanted = study.base_settings;
  for (const auto& [knob, setting] : study.reference.point) wanted[index_of(study.knobs, knob)] = setting;
  const auto found = std::find_if(result.points.begin(), result.points.end(), [&](const auto& p) { return p.settings == wanted; });
  for (std::size_t o = 0; o < study.observables.size(); ++o) {
    result.reference.values.push_back(found == result.points.end() ? Estimate{.reason = "the point of the reference is missing"} : found->observed[o]);
    result.reference_from.push_back(found == result.points.end() ? "a point that is missing" : "the point " + found->name);
  }
}

void take_values(StudyResult& result) {
  for (const std::string& name : result.study.observables) {
    const auto& given = result.study.reference.values.at(name);
    result.reference.values.push_back({.value = given.value, .error = given.error, .converged = true});
    result.reference_from.push_back("given by the study");
  }
}

}  // namespace

StudyResult evaluate(Study study, std::vector<StudyEntry> entries) {
  StudyResult result;
  result.study = std::move(study);
  result.entries = std::move(entries);
  for (const StudyEntry& entry : result.entries) result.points.push_back(entry.point);
  const StudyReference& reference = result.study.reference;
  if (!reference.extrapolate.empty()) extrapolate(result);
  else if (!reference.point.empty()) take_point(result);
  else take_values(result);

  for (const auto& p : result.points) result.deviations.push_back(tradeoff::deviation(p, result.reference));
  result.front = tradeoff::pareto_front(result.points, result.deviations);
  for (std::size_t k = 0; k < result.study.knobs.size(); ++k) {
    const auto orders = tradeoff::convergence_orders(result.points, result.deviations, k);
    result.orders.insert(result.orders.end(), orders.begin(), orders.end());
  }
  result.steps = tradeoff::knob_steps(result.points, result.deviations, result.study.knobs.size());
  result.limiting = tradeoff::limiting_knobs(result.points, result.deviations, result.front);

  for (std::size_t o = 0; o < result.study.observables.size(); ++o) {
    const Estimate& r = result.reference.values[o];
    if (!r.converged) result.warnings.push_back(fmt::format("the reference of {} isn't certain: {}", result.study.observables[o], r.reason));
  }
  for (const StudyEntry& entry : result.entries)
    if (entry.state != "finished") result.warnings.push_back(fmt::format("{}: {}{}{}", entry.point.name, entry.state, entry.message.empty() ? "" : ": ", entry.message));
  for (std::size_t o = 0; o < result.study.observables.size(); ++o) {
    std::size_t doubtful = 0, finished = 0, first = 0;
    for (std::size_t i = 0; i < result.points.size(); ++i) {
      if (result.entries[i].state != "finished") continue;
      ++finished;
      if (result.points[i].observed[o].converged) continue;
      if (doubtful++ == 0) first = i;
    }
    if (doubtful > 0)
      result.warnings.push_back(fmt::format("{}: not converged in {} of {} points, for example {}: {}", result.study.observables[o], doubtful, finished, result.points[first].name,
                                            result.points[first].observed[o].reason));
  }
  return result;
}

}  // namespace corpuscle
