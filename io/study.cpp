#include "io/study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.hpp"
#include "io/scene.hpp"
#include "io/scene_keys.hpp"
#include "io/scene_toml.hpp"
#include "physics/analysis/results.hpp"

namespace corpuscle {
namespace {

using scene::one_line;
using scene::shown;

constexpr const char* seed = "run.seed";

/// Numbers in one spelling, texts without quotes, lists without blanks; "default" for what isn't set.
std::string plain_setting(std::string text) {
  if (text.empty()) return "default";
  if (text.front() == '[') std::erase(text, ' ');
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') return text.substr(1, text.size() - 2);
  try {
    std::size_t end = 0;
    const double value = std::stod(text, &end);
    if (end == text.size()) return fmt::format("{}", value);
  } catch (const std::exception&) {
  }
  return text;
}

class StudyReader {
 public:
  StudyReader(std::string_view text, const std::string& origin)
      : origin_(one_line(origin, 300)), root_(scene::parse_table(text, origin_, "a study is a sweep (docs/sweep.md) with a table [study], see docs/tradeoff.md")) {
    study_.sweep = parse_sweep(text, origin, "study");
  }

  Study read() {
    const toml::node* node = root_.get("study");
    if (node == nullptr || !node->is_table()) throw InputError(fmt::format("{}: [study] is missing: it names the observables and what they are compared with, see docs/tradeoff.md", origin_));
    const toml::table& table = *node->as_table();
    static constexpr std::array<std::string_view, 5> known{"observables", "wall_layer", "discard", "fraction", "reference"};
    allow_only(table, known, "[study]");
    read_observables(table);
    study_.wall_layer = number(table, "wall_layer").value_or(study_.wall_layer);
    study_.discard = number(table, "discard");
    if (const toml::node* fraction = table.get("fraction")) read_fraction(*fraction);
    find_knobs();
    read_reference(table);
    return std::move(study_);
  }

 private:
  [[noreturn]] void fail(const toml::node& node, const std::string& problem) const { scene::refuse(origin_, node.source().begin.line, problem); }
  void allow_only(const toml::table& table, std::span<const std::string_view> known, const char* of) const { scene::allow_only(origin_, table, known, of); }
  std::optional<double> number(const toml::table& table, const char* key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) return {};
    const auto value = node->value<double>();
    if (!value || !std::isfinite(*value) || *value < 0) fail(*node, fmt::format("{} = {} must be a number >= 0", key, shown(*node)));
    return value;
  }
  std::string known_observable(const toml::node& node, const std::string& name) const {
    const auto names = observable_names();
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      const std::vector<std::string_view> views(names.begin(), names.end());
      fail(node, fmt::format("{} isn't a result of corpuscle analyse; the nearest is {}", one_line(name), scene::nearest(name, views)));
    }
    return name;
  }
  std::vector<std::string> texts(const toml::node& node, const char* what) const {
    std::vector<std::string> list;
    if (const toml::array* array = node.as_array())
      for (const toml::node& entry : *array) {
        if (!entry.is_string()) fail(entry, fmt::format("{} = {} must be a list of names", what, shown(node)));
        list.push_back(entry.as_string()->get());
      }
    if (list.empty()) fail(node, fmt::format("{} = {} must be a list with at least one name", what, shown(node)));
    return list;
  }

  void read_observables(const toml::table& table) {
    const toml::node* node = table.get("observables");
    if (node == nullptr) fail(table, "[study] needs observables = [...], names of results of corpuscle analyse such as \"relative_viscosity\"");
    for (const std::string& name : texts(*node, "observables")) {
      if (std::find(study_.observables.begin(), study_.observables.end(), name) != study_.observables.end()) fail(*node, fmt::format("observables names {} twice", name));
      study_.observables.push_back(known_observable(*node, name));
    }
  }

  void read_fraction(const toml::node& node) {
    constexpr const char* form = "must be a table such as { phi = 0.45, exponents = { relative_viscosity = 1.6 } }";
    if (!node.is_table()) fail(node, fmt::format("fraction = {} {}", shown(node), form));
    const toml::table& table = *node.as_table();
    static constexpr std::array<std::string_view, 2> known{"phi", "exponents"};
    allow_only(table, known, "[study.fraction]");
    const auto phi = number(table, "phi");
    const toml::table* exponents = table["exponents"].as_table();
    if (!phi || exponents == nullptr) fail(node, fmt::format("[study.fraction] {}", form));
    if (!(*phi > 0 && *phi < 1)) fail(node, fmt::format("phi = {:g} must be > 0 and < 1", *phi));
    study_.fraction = StudyFraction{*phi, {}};
    for (const auto& [name, value] : *exponents) {
      const std::string observable(name.str());
      if (std::find(study_.observables.begin(), study_.observables.end(), observable) == study_.observables.end())
        fail(value, fmt::format("{} is none of the observables: {}", one_line(observable), fmt::join(study_.observables, ", ")));
      const auto exponent = value.value<double>();
      if (!exponent || !(std::abs(*exponent) <= 10)) fail(value, fmt::format("{} = {} must be a number between -10 and 10", observable, shown(value)));
      study_.fraction->exponents[observable] = *exponent;
    }
  }

  void find_knobs() {
    const Problem base = read_scene(study_.sweep.scene);
    std::vector<const SweepAxis*> axis_of;
    for (const SweepAxis& axis : study_.sweep.axes) {
      if (axis.name == seed) continue;
      study_.knobs.push_back(axis.name);
      axis_of.push_back(&axis);
    }
    const auto in_axis = [&](const std::string& key) {
      return std::any_of(axis_of.begin(), axis_of.end(), [&](const SweepAxis* axis) {
        return axis != nullptr && std::any_of(axis->settings.begin(), axis->settings.end(), [&](const auto& setting) {
          return std::any_of(setting.overrides.begin(), setting.overrides.end(), [&](const Override& o) { return o.key == key; });
        });
      });
    };
    for (const SweepPoint& point : study_.sweep.points)
      for (const Override& o : std::span(point.overrides).first(point.given)) {  // what a [[where]] adds, such as a length, belongs to its point
        if (o.key == seed || in_axis(o.key) || std::find(study_.knobs.begin(), study_.knobs.end(), o.key) != study_.knobs.end()) continue;
        study_.knobs.push_back(o.key);
        axis_of.push_back(nullptr);
      }
    if (study_.knobs.empty()) throw InputError(fmt::format("{}: nothing varies but the seed: give an [[axis]] with a knob such as accuracy.radius", origin_));

    const auto setting = [&](std::size_t knob, const Problem& problem) -> std::string {
      const auto value = [&](const std::string& key) { return plain_setting(scene_value(problem, key)); };
      if (axis_of[knob] == nullptr || axis_of[knob]->is_key) return value(study_.knobs[knob]);
      // The setting with the most overrides that the point has: one may be a part of another.
      const SweepAxis::Setting* best = nullptr;
      for (const auto& s : axis_of[knob]->settings) {
        const bool has = std::all_of(s.overrides.begin(), s.overrides.end(), [&](const Override& o) { return value(o.key) == plain_setting(o.value); });
        if (has && (best == nullptr || s.overrides.size() > best->overrides.size())) best = &s;
      }
      return best == nullptr ? "base" : best->label;
    };
    for (std::size_t knob = 0; knob < study_.knobs.size(); ++knob) study_.base_settings.push_back(setting(knob, base));
    for (const SweepPoint& point : study_.sweep.points) {
      const Problem problem = read_scene(study_.sweep.scene, point.texts());
      study_.settings.emplace_back();
      for (std::size_t knob = 0; knob < study_.knobs.size(); ++knob) study_.settings.back().push_back(setting(knob, problem));
    }
  }

  void require_knob(const toml::node& node, const std::string& name) const {
    if (std::find(study_.knobs.begin(), study_.knobs.end(), name) != study_.knobs.end()) return;
    fail(node, fmt::format("{} is no knob of this study; its knobs are {}", one_line(name), fmt::join(study_.knobs, ", ")));
  }

  void read_reference(const toml::table& study) {
    const toml::node* node = study.get("reference");
    if (node == nullptr || !node->is_table()) {
      fail(node == nullptr ? static_cast<const toml::node&>(study) : *node,
           "[study.reference] is missing: give extrapolate = \"accuracy.radius\", point = { ... } with the settings of one point, or values = { ... } with published values");
    }
    const toml::table& table = *node->as_table();
    static constexpr std::array<std::string_view, 4> known{"extrapolate", "same_limit", "point", "values"};
    allow_only(table, known, "[study.reference]");
    const int kinds = int(table.contains("extrapolate")) + int(table.contains("point")) + int(table.contains("values"));
    if (kinds != 1) fail(table, "[study.reference] needs exactly one of extrapolate, point, values");
    if (table.contains("same_limit") && !table.contains("extrapolate")) fail(*table.get("same_limit"), "same_limit has a meaning with extrapolate only");
    StudyReference& reference = study_.reference;
    if (const toml::node* knob = table.get("extrapolate")) {
      if (!knob->is_string()) fail(*knob, fmt::format("extrapolate = {} must be the name of a knob", shown(*knob)));
      reference.extrapolate = knob->as_string()->get();
      require_knob(*knob, reference.extrapolate);
      const auto index = static_cast<std::size_t>(std::find(study_.knobs.begin(), study_.knobs.end(), reference.extrapolate) - study_.knobs.begin());
      for (const auto& settings : study_.settings)
        if (!(std::atof(settings[index].c_str()) > 0)) fail(*knob, fmt::format("extrapolate = {}, but {} is no positive number", shown(*knob), settings[index]));
      if (const toml::node* same = table.get("same_limit"))
        for (const std::string& name : texts(*same, "same_limit")) {
          require_knob(*same, name);
          if (name == reference.extrapolate) fail(*same, fmt::format("{} is the knob of the extrapolation", name));
          reference.same_limit.push_back(name);
        }
    } else if (const toml::node* point = table.get("point")) {
      if (!point->is_table() || point->as_table()->empty()) fail(*point, "point must be a table of knobs and their settings");
      for (const auto& [name, value] : *point->as_table()) {
        require_knob(value, std::string(name.str()));
        reference.point[std::string(name.str())] = plain_setting(value.is_string() ? value.as_string()->get() : shown(value));
      }
      if (std::none_of(study_.settings.begin(), study_.settings.end(), [&](const auto& settings) { return is_reference_point(settings); }))
        fail(*point, "no point of the study has these settings");
    } else {
      const toml::node* values = table.get("values");
      if (!values->is_table()) fail(*values, "values must be a table: observable = value, or observable = [value, error]");
      for (const auto& [name, value] : *values->as_table()) {
        const std::string observable = known_observable(value, std::string(name.str()));
        const toml::array* pair = value.as_array();
        const auto number = pair != nullptr && pair->size() == 2 ? pair->get(0)->value<double>() : value.value<double>();
        const auto error = pair != nullptr && pair->size() == 2 ? pair->get(1)->value<double>() : std::optional(0.0);
        if (!number || !error || !std::isfinite(*number) || *number == 0 || !(*error >= 0)) fail(value, fmt::format("{} = {} must be a number, or [value, error]", observable, shown(value)));
        reference.values[observable] = {*number, *error};
      }
      for (const std::string& observable : study_.observables)
        if (!reference.values.contains(observable)) fail(*values, fmt::format("values lacks the observable {}", observable));
    }
  }
  bool is_reference_point(const std::vector<std::string>& settings) const {
    for (std::size_t k = 0; k < study_.knobs.size(); ++k) {
      const auto wanted = study_.reference.point.find(study_.knobs[k]);
      if (settings[k] != (wanted == study_.reference.point.end() ? study_.base_settings[k] : wanted->second)) return false;
    }
    return true;
  }

  std::string origin_;
  toml::table root_;
  Study study_;
};

}  // namespace

Study parse_study(std::string_view text, const std::string& origin) { return StudyReader(text, origin).read(); }

Study read_study(const std::string& path) { return parse_study(scene::read_text(path, "study"), path); }

std::vector<std::vector<std::size_t>> repeats_of(const Study& study) {
  std::vector<std::vector<std::size_t>> groups;
  std::map<std::vector<std::string>, std::size_t> group_of;
  for (std::size_t i = 0; i < study.settings.size(); ++i) {
    const auto [found, is_new] = group_of.emplace(study.settings[i], groups.size());
    if (is_new) groups.emplace_back();
    groups[found->second].push_back(i);
  }
  return groups;
}

statistics::Estimate at_fraction(statistics::Estimate e, const std::string& observable, double phi, const std::optional<StudyFraction>& fraction) {
  if (!fraction || !(phi > 0)) return e;
  const auto exponent = fraction->exponents.find(observable);
  if (exponent == fraction->exponents.end()) return e;
  const double factor = std::pow(fraction->phi / phi, exponent->second);
  const double without_cells = observable.find("relative_viscosity") == std::string::npos ? 0 : 1;
  e.value = without_cells + (e.value - without_cells) * factor;
  e.error *= factor;
  return e;
}

std::vector<std::string> observable_names() {
  std::vector<std::string> names;
  for (const auto& item : analysis::Analysis().estimates) names.push_back(item.name);
  return names;
}

}  // namespace corpuscle
