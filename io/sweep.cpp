#include "io/sweep.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <unordered_set>

#include "core/error.hpp"
#include "io/scene_keys.hpp"
#include "io/scene_toml.hpp"

namespace corpuscle {
namespace {

using scene::one_line;
using scene::shown;

/// Far more than a sweep needs; with them, reading one takes seconds and some hundred megabytes at most, whatever the file says.
constexpr std::size_t most_overrides = 32;  ///< of a point, and keys in a match
constexpr std::size_t most_rules = 100;
constexpr std::size_t most_settings = 100;  ///< of an axis that changes several keys
constexpr std::size_t longest_value = 500;

/// A value of the sweep file. Equal values have equal texts: 2.8e-3 and 0.0028, 1.0 and 1 (numbers are written in the shortest way that gives them back).
struct Value {
  std::string text;  ///< TOML and JSON
  std::vector<std::string> parts;  ///< of a list
};

const Override* find(const std::vector<Override>& overrides, const std::string& key) {
  const auto found = std::find_if(overrides.begin(), overrides.end(), [&](const Override& o) { return o.key == key; });
  return found == overrides.end() ? nullptr : &*found;
}

/// [[where]]
struct Rule {
  std::vector<std::pair<std::string, std::set<std::string>>> match;  ///< for each key the values that will do
  std::vector<Override> set;
  std::ptrdiff_t line = 0;
};

class SweepReader {
 public:
  SweepReader(std::string_view text, const std::string& origin, std::string_view more)
      : origin_(one_line(origin, 300)), path_(origin), more_(more), root_(scene::parse_table(text, origin_, "a sweep starts with scene = \"base.toml\" and [[axis]], see docs/sweep.md")) {}

  Sweep read() {
    std::vector<std::string_view> known{"scene", "axis", "also", "where"};
    if (!more_.empty()) known.push_back(more_);
    allow_only(root_, known, more_.empty() ? "a sweep" : "a study");
    Sweep sweep;
    const toml::node* scene = root_.get("scene");
    if (scene == nullptr) throw InputError(fmt::format("{}: `scene` is missing: name the scene that varies, for example scene = \"base.toml\"", origin_));
    if (!scene->is_string() || scene->as_string()->get().empty()) fail(*scene, fmt::format("scene = {} must be the name of a scene file, beside this one", shown(*scene)));
    sweep.scene = (std::filesystem::path(path_).parent_path() / scene->as_string()->get()).lexically_normal().string();
    for (const toml::table* table : tables("axis")) read_axis(*table);
    given_ = matrix();
    for (const toml::table* table : tables("also")) read_also(*table);
    if (given_.empty()) throw InputError(fmt::format("{}: has no points: write at least one [[axis]] with key and values, or [[also]], see docs/sweep.md", origin_));
    for (const toml::table* table : tables("where")) read_rule(*table);

    const std::vector<std::string> names = sweep_names(named_);
    check_names(names);
    for (std::size_t i = 0; i < given_.size(); ++i) sweep.points.push_back({names[i], given_[i], given_[i].size()});
    for (const Rule& rule : rules_) apply(rule, sweep);
    sweep.axes = std::move(axes_);
    return sweep;
  }

 private:
  [[noreturn]] void fail(const toml::node& node, const std::string& problem) const { scene::refuse(origin_, node.source().begin.line, problem); }

  void allow_only(const toml::table& table, std::span<const std::string_view> known, const char* of) const { scene::allow_only(origin_, table, known, of); }

  std::vector<const toml::table*> tables(const char* name) const {
    std::vector<const toml::table*> found;
    const toml::node* node = root_.get(name);
    if (node == nullptr) return found;
    const toml::array* list = node->as_array();
    if (list == nullptr) fail(*node, fmt::format("{} must be a list of tables: write [[{}]] with two brackets for each", name, name));
    for (const toml::node& entry : *list) {
      if (!entry.is_table()) fail(entry, fmt::format("{} = {} must be a table: write [[{}]] with two brackets for each", name, shown(entry), name));
      found.push_back(entry.as_table());
    }
    return found;
  }

  void require_key(const std::string& key, const toml::node& node) const {
    const std::string pattern = scene::pattern_of(key);
    if (scene::find_key(pattern) != nullptr) {
      const bool starred = key.starts_with("cells.*"), padded = key.starts_with("cells.0") && !key.starts_with("cells.0.");
      if (starred || padded) fail(node, fmt::format("{} must give the number of a cell type, from 0 and without leading zeros, for example cells.0.count", one_line(key, 120)));
      return;
    }
    if (pattern == "cells" || scene::is_section(pattern)) fail(node, fmt::format("{} is a table of a scene: give a key in it", one_line(key, 120)));
    fail(node, fmt::format("{} isn't a key of a scene; the nearest known key is {}", one_line(key, 120), scene::nearest_key(pattern)));
  }

  Value value(const std::string& key, const toml::node& node) const {
    Value result;
    if (const toml::array* list = node.as_array()) {
      if (list->size() > most_sweep_points) fail(node, fmt::format("{} has a list of {} values; at most {} are allowed", one_line(key, 120), list->size(), most_sweep_points));
      for (const toml::node& part : *list) {
        const Value inner = value(key, part);
        if (!inner.parts.empty()) fail(node, fmt::format("{} = {} is a list of lists, which no key takes", one_line(key, 120), shown(node)));
        result.parts.push_back(inner.text);
      }
      result.text = fmt::format("[{}]", fmt::join(result.parts, ", "));
    } else if (const auto* text = node.as_string()) result.text = scene::quote(text->get());
    else if (const auto* number = node.as_floating_point(); number != nullptr && std::isfinite(number->get()))
      result.text = fmt::format("{}", number->get() == 0 ? 0 : number->get());  // -0.0 is 0
    else if (const auto* whole = node.as_integer()) result.text = fmt::format("{}", whole->get());
    else if (const auto* choice = node.as_boolean()) result.text = choice->get() ? "true" : "false";
    else fail(node, fmt::format("{} = {} must be a number, a string, true, false or a list of them", one_line(key, 120), shown(node)));
    return result;
  }

  Override override_with(const std::string& key, const Value& value, const toml::node& node) const {
    if (value.text.size() > longest_value)
      fail(node, fmt::format("{} = {} has {} characters; a value may have {} at most", one_line(key, 120), one_line(value.text), value.text.size(), longest_value));
    return {key, value.text};
  }

  /// The overrides in a table; `a.b = 1`, `"a.b" = 1` and `a = { b = 1 }` are the same.
  void collect(const toml::table& table, const std::string& prefix, std::vector<std::pair<std::string, Value>>& into) const {
    for (const auto& [name, node] : table) {
      const std::string key = prefix + std::string(name.str());
      if (const toml::table* inner = node.as_table()) {
        collect(*inner, key + ".", into);
        continue;
      }
      require_key(key, node);
      if (std::any_of(into.begin(), into.end(), [&](const auto& other) { return other.first == key; })) fail(node, fmt::format("{} is given twice", key));
      if (into.size() == most_overrides) fail(node, fmt::format("{} is one key too many: a point, a set or a match has {} at most; put the others into the scene", key, most_overrides));
      into.emplace_back(key, value(key, node));
    }
  }
  std::vector<Override> overrides(const toml::table& table) const {
    std::vector<std::pair<std::string, Value>> values;
    collect(table, "", values);
    std::vector<Override> list;
    for (const auto& [key, v] : values) list.push_back(override_with(key, v, table));
    return list;
  }

  void read_axis(const toml::table& table) {
    static constexpr std::array<std::string_view, 4> known{"key", "values", "name", "settings"};
    allow_only(table, known, "[[axis]]");
    if (table.contains("name") || table.contains("settings")) return read_settings(table);
    const toml::node *key = table.get("key"), *values = table.get("values");
    if (key == nullptr || !key->is_string()) fail(key == nullptr ? table : *key, "an [[axis]] needs key = \"...\", a key of the scene such as \"flow.capillary_number\"");
    SweepAxis axis{key->as_string()->get(), true, {}};
    require_key(axis.name, *key);
    require_room(table);
    if (rank(axis.name) < axes_.size()) fail(*key, fmt::format("{} has an axis already: put all its values into one", axis.name));
    if (values == nullptr || !values->is_array() || values->as_array()->empty())
      fail(values == nullptr ? table : *values, fmt::format("the axis of {} needs values = [...], a list with at least one value", axis.name));
    if (values->as_array()->size() > most_sweep_points)
      fail(*values, fmt::format("the axis of {} has {} values; a sweep has at most {} points", axis.name, values->as_array()->size(), most_sweep_points));
    std::unordered_set<std::string> seen;
    for (const toml::node& node : *values->as_array()) {
      const Override o = override_with(axis.name, value(axis.name, node), node);
      if (!seen.insert(o.value).second) fail(node, fmt::format("the axis of {} has the value {} twice", axis.name, one_line(o.value)));
      axis.settings.push_back({o.value, {o}});
    }
    axes_.push_back(std::move(axis));
  }

  void require_room(const toml::table& table) const {
    if (axes_.size() == most_overrides) fail(table, fmt::format("there are more than {} axes: put values that don't vary into the scene", most_overrides));
  }

  /// An axis whose settings change several keys.
  void read_settings(const toml::table& table) {
    const toml::node *name = table.get("name"), *settings = table.get("settings");
    if (table.contains("key") || table.contains("values")) fail(table, "an [[axis]] has key and values, or name and settings, not both");
    const std::string word = name != nullptr && name->is_string() ? name->as_string()->get() : "";
    if (!is_word(word)) fail(name == nullptr ? table : *name, "an [[axis]] with settings needs name = \"...\", a word of letters, digits, - and _");
    if (scene::find_key(scene::pattern_of(word)) != nullptr || rank(word) < axes_.size()) fail(*name, fmt::format("{} is a key of the scene or another axis: choose another name", word));
    if (settings == nullptr || !settings->is_array() || settings->as_array()->empty())
      fail(settings == nullptr ? table : *settings, fmt::format("the axis {} needs settings = [{{ label = \"...\", set = {{ ... }} }}, ...], a list with at least one setting", word));
    require_room(table);
    if (settings->as_array()->size() > most_settings) fail(*settings, fmt::format("the axis {} has {} settings; at most {} are allowed", word, settings->as_array()->size(), most_settings));
    SweepAxis axis{word, false, {}};
    for (const toml::node& node : *settings->as_array()) {
      const toml::table* entry = node.as_table();
      static constexpr std::array<std::string_view, 2> parts{"label", "set"};
      if (entry == nullptr) fail(node, fmt::format("a setting of {} must be a table: {{ label = \"...\", set = {{ ... }} }}", word));
      allow_only(*entry, parts, "a setting");
      const toml::node *label = entry->get("label"), *set = entry->get("set");
      const std::string text = label != nullptr && label->is_string() ? label->as_string()->get() : "";
      if (!is_word(text)) fail(label == nullptr ? node : *label, fmt::format("a setting of {} needs label = \"...\", a word of letters, digits, - and _", word));
      if (std::any_of(axis.settings.begin(), axis.settings.end(), [&](const auto& other) { return other.label == text; }))
        fail(*label, fmt::format("{} has the label {} twice", word, text));
      if (set == nullptr || !set->is_table()) fail(set == nullptr ? node : *set, fmt::format("the setting {} needs set = {{ ... }} with its overrides ({{}} for the base scene)", text));
      axis.settings.push_back({text, overrides(*set->as_table())});
      for (const Override& o : axis.settings.back().overrides)
        if (rank(o.key) < axes_.size()) fail(*set, fmt::format("{} has an axis already", o.key));
    }
    axes_.push_back(std::move(axis));
  }
  static bool is_word(const std::string& text) {
    return !text.empty() && text.size() <= 60 && std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_'; });
  }

  std::vector<std::vector<Override>> matrix() {
    if (axes_.empty()) return {};
    std::vector<std::vector<Override>> points{{}};
    named_ = points;
    for (const SweepAxis& axis : axes_) {
      if (points.size() * axis.settings.size() > most_sweep_points)
        throw InputError(fmt::format("{}: the axes give more than {} points: use fewer values", origin_, most_sweep_points));
      std::vector<std::vector<Override>> more, names;
      for (std::size_t i = 0; i < points.size(); ++i)
        for (const auto& setting : axis.settings) {
          more.push_back(points[i]);
          more.back().insert(more.back().end(), setting.overrides.begin(), setting.overrides.end());
          if (more.back().size() > most_overrides)
            throw InputError(fmt::format("{}: the axes give points with more than {} overrides: put what all points have into the scene", origin_, most_overrides));
          names.push_back(named_[i]);
          names.back().push_back({axis.name, axis.is_key ? setting.label : scene::quote(setting.label)});
        }
      points = std::move(more);
      named_ = std::move(names);
    }
    return points;
  }

  void read_also(const toml::table& table) {
    if (given_.size() >= most_sweep_points) fail(table, fmt::format("more than {} points: use fewer", most_sweep_points));
    given_.push_back(overrides(table));
    // In the order of the axes, so that names read alike.
    std::stable_sort(given_.back().begin(), given_.back().end(), [&](const Override& a, const Override& b) { return rank(a.key) < rank(b.key); });
    named_.push_back(given_.back());
  }
  /// The axis of a key, or of a name.
  std::size_t rank(const std::string& key) const {
    const auto has = [&](const SweepAxis& axis) {
      if (axis.is_key || axis.name == key) return axis.name == key;
      return std::any_of(axis.settings.begin(), axis.settings.end(), [&](const auto& setting) { return find(setting.overrides, key) != nullptr; });
    };
    return static_cast<std::size_t>(std::find_if(axes_.begin(), axes_.end(), has) - axes_.begin());
  }

  void read_rule(const toml::table& table) {
    static constexpr std::array<std::string_view, 2> known{"match", "set"};
    allow_only(table, known, "[[where]]");
    const toml::node *match = table.get("match"), *set = table.get("set");
    if (match == nullptr || !match->is_table() || match->as_table()->empty())
      fail(table, "a [[where]] needs match = { ... } with the values of the points that it is for, for example match = { \"flow.capillary_number\" = 0.0028 }");
    if (set == nullptr || !set->is_table() || set->as_table()->empty())
      fail(table, "a [[where]] needs set = { ... } with the overrides of these points, for example set = { \"run.strain\" = 20 }");
    if (rules_.size() == most_rules) fail(table, fmt::format("there are more than {} [[where]]: write one for several values as a list in its match", most_rules));
    Rule rule;
    rule.line = table.source().begin.line;
    std::vector<std::pair<std::string, Value>> wanted;
    collect(*match->as_table(), "", wanted);
    for (const auto& [key, v] : wanted) {
      rule.match.emplace_back(key, std::set<std::string>(v.parts.begin(), v.parts.end()));
      rule.match.back().second.insert(v.text);
    }
    rule.set = overrides(*set->as_table());
    for (const Override& o : rule.set)
      if (rank(o.key) < axes_.size()) fail(*set, fmt::format("[[where]] can't set {}, which has an axis: write the points with another value as [[also]]", o.key));
    rules_.push_back(std::move(rule));
  }

  /// What a point gives itself wins over the rules; a later rule over an earlier one.
  void apply(const Rule& rule, Sweep& sweep) const {
    bool any = false;
    for (std::size_t i = 0; i < sweep.points.size(); ++i) {
      const bool matches = std::all_of(rule.match.begin(), rule.match.end(), [&](const auto& wanted) {
        const Override* own = find(given_[i], wanted.first);
        return own != nullptr && wanted.second.contains(own->value);
      });
      any = any || matches;
      if (!matches) continue;
      for (const Override& o : rule.set) {
        if (find(given_[i], o.key) != nullptr) continue;
        auto& overrides = sweep.points[i].overrides;
        const auto earlier = std::find_if(overrides.begin(), overrides.end(), [&](const Override& other) { return other.key == o.key; });
        if (earlier != overrides.end()) *earlier = o;
        else if (overrides.size() < most_overrides) overrides.push_back(o);
        else scene::refuse(origin_, rule.line, fmt::format("this [[where]] gives the point {} more than {} overrides: put what all points have into the scene", sweep.points[i].name, most_overrides));
      }
    }
    if (!any) scene::refuse(origin_, rule.line, "this [[where]] matches no point: match compares with what [[axis]] and [[also]] give, all of it must agree");
  }

  void check_names(const std::vector<std::string>& names) const {
    std::map<std::string, std::size_t> seen;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i].size() > 200) throw InputError(fmt::format("{}: point {} would need a directory name of {} characters ({}): use shorter texts or fewer keys", origin_,
                                                              i + 1, names[i].size(), one_line(names[i])));
      const auto [first, is_new] = seen.emplace(names[i], i);
      if (is_new) continue;
      const bool same = given_[first->second].size() == given_[i].size() &&
                        std::all_of(given_[i].begin(), given_[i].end(), [&](const Override& o) {
                          const Override* other = find(given_[first->second], o.key);
                          return other != nullptr && other->value == o.value;
                        });
      if (same) throw InputError(fmt::format("{}: the point {} is there twice: leave out the [[also]] that repeats it", origin_, names[i]));
      throw InputError(fmt::format("{}: two points would have the directory {}: choose texts that differ in letters or digits", origin_, names[i]));
    }
  }

  std::string origin_, path_, more_;
  toml::table root_;
  std::vector<SweepAxis> axes_;
  std::vector<std::vector<Override>> given_;  ///< by axes and [[also]], of each point
  std::vector<std::vector<Override>> named_;  ///< the same with the labels of settings, for names
  std::vector<Rule> rules_;
};

}  // namespace

Sweep parse_sweep(std::string_view text, const std::string& origin, std::string_view more) { return SweepReader(text, origin, more).read(); }

Sweep read_sweep(const std::string& path) { return parse_sweep(scene::read_text(path, "sweep"), path); }

}  // namespace corpuscle
