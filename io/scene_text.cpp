// Text made from the table of keys: values, types, suggestions, the merged scene, the reference.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <type_traits>

#include "core/error.hpp"
#include "io/scene.hpp"
#include "io/scene_keys.hpp"
#include "io/scene_si.hpp"

namespace corpuscle::scene {

namespace {

template <class T>
struct Unwrapped { using type = T; };
template <class T>
struct Unwrapped<std::optional<T>> { using type = T; };

}  // namespace

bool Range::contains(double value) const { return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high); }

std::string Range::text() const { return fmt::format("{} {:g} and {} {:g}", low_open ? ">" : ">=", low, high_open ? "<" : "<=", high); }

std::vector<std::string_view> choice_list(const Key& key) {
  std::vector<std::string_view> list;
  for (std::string_view rest = key.choices; !rest.empty();) {
    const std::size_t bar = rest.find('|');
    list.push_back(rest.substr(0, bar));
    rest = bar == std::string_view::npos ? std::string_view{} : rest.substr(bar + 1);
  }
  return list;
}

std::string type_name(const Key& key) {
  Problem problem;
  CellSpec cell;
  return std::visit(
      [](auto* field) -> std::string {
        using T = typename Unwrapped<std::remove_pointer_t<decltype(field)>>::type;
        if constexpr (std::is_same_v<T, bool>) return "true or false";
        else if constexpr (std::is_same_v<T, double>) return "number";
        else if constexpr (std::is_same_v<T, std::array<double, 3>>) return "list of 3 numbers";
        else if constexpr (std::is_same_v<T, std::string> || std::is_enum_v<T>) return "string";
        else return "whole number";
      },
      key.field(problem, cell));
}

std::string quote(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += fmt::format("\\{}", c);
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) out += fmt::format("\\u{:04X}", static_cast<unsigned char>(c));
    else out += c;
  }
  return out + "\"";
}

std::string value_text(const Key& key, const Field& field) {
  const auto text = [&](const auto& value) -> std::string {
    using T = std::decay_t<decltype(value)>;
    if constexpr (std::is_enum_v<T>) return quote(choice_list(key).at(static_cast<std::size_t>(value)));
    else if constexpr (std::is_same_v<T, std::string>) return quote(value);
    else if constexpr (std::is_same_v<T, std::array<double, 3>>) return fmt::format("[{}, {}, {}]", value[0], value[1], value[2]);
    else return fmt::format("{}", value);
  };
  return std::visit(
      [&](auto* value) -> std::string {
        using T = std::remove_pointer_t<decltype(value)>;
        if constexpr (std::is_same_v<T, typename Unwrapped<T>::type>) return text(*value);
        else return value->has_value() ? text(**value) : std::string{};
      },
      field);
}

int edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<int>> cost(a.size() + 1, std::vector<int>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        cost[i][j] = static_cast<int>(i + j);
        continue;
      }
      const int substitute = cost[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
      cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, substitute});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  }
  return cost[a.size()][b.size()];
}

std::string_view nearest(std::string_view word, std::span<const std::string_view> candidates) {
  word = word.substr(0, 100);  // a garbage key may be megabytes long
  return *std::min_element(candidates.begin(), candidates.end(), [&](std::string_view a, std::string_view b) { return edit_distance(word, a) < edit_distance(word, b); });
}

std::string_view nearest_key(std::string_view name) {
  name = name.substr(0, 200);
  const std::size_t dot = name.rfind('.');
  const std::string_view leaf = dot == std::string_view::npos ? name : name.substr(dot + 1);
  const std::string_view section = dot == std::string_view::npos ? std::string_view{} : name.substr(0, dot);
  // A leaf in the wrong section costs one edit more, so that flow.radius finds accuracy.radius and box.sise finds box.size. For an unknown
  // section its own spelling decides between equal leaves, for a known one the order of the table.
  const bool known = is_section(section);
  const auto cost = [&](const Key& key) {
    const int other_section = key.section() == section ? 0 : 10 + (known ? 0 : edit_distance(section, key.section()));
    return 10 * edit_distance(leaf, key.leaf()) + other_section;
  };
  return std::min_element(keys().begin(), keys().end(), [&](const Key& a, const Key& b) { return cost(a) < cost(b); })->name;
}

namespace {

/// One section of the merged scene; unset optionals appear as comments, so that a reader sees what could be set.
void write_section(std::string& out, std::string_view section, const Problem& problem, const CellSpec& cell) {
  Problem p = problem;
  CellSpec c = cell;
  for (const Key& key : keys()) {
    std::string reason;
    if (key.section() != section || !applies(key, problem, cell, reason)) continue;
    if (key.name == "run.strain" && (problem.run.steps || problem.run.duration || problem.flow.kind == FlowKind::rest)) continue;
    const std::string value = value_text(key, key.field(p, c));
    if (value.empty()) out += fmt::format("# {} not set: {}\n", key.leaf(), key.default_note);
    else out += fmt::format("{} = {}\n", key.leaf(), value);
  }
  out += "\n";
}

std::string allowed_text(const Key& key) {
  if (!key.choices.empty()) return fmt::format("`{}`", fmt::join(choice_list(key), "`, `"));
  const std::string type = type_name(key);
  if (type == "true or false" || type == "string") return "";
  return key.range.text();
}

}  // namespace
}  // namespace corpuscle::scene

namespace corpuscle {

std::string to_toml(const Problem& problem) {
  using scene::write_section;
  std::string out;
  const CellSpec none;
  if (problem.si.radius || problem.si.viscosity || problem.si.shear_modulus) {
    out += "[si]\n";
    write_section(out, "si", problem, none);
  }
  for (const char* section : {"box", "flow"}) {
    out += fmt::format("[{}]\n", section);
    write_section(out, section, problem, none);
  }
  for (const CellSpec& cell : problem.cells) {
    out += "[[cells]]\n";
    write_section(out, "cells.*", problem, cell);
    out += "[cells.membrane]\n";
    write_section(out, "cells.*.membrane", problem, cell);
    if (!cell.stretch.force) continue;
    out += "[cells.stretch]\n";
    write_section(out, "cells.*.stretch", problem, cell);
  }
  for (const char* section : {"contact", "guards", "accuracy", "run", "output"}) {
    out += fmt::format("[{}]\n", section);
    write_section(out, section, problem, none);
  }
  out.pop_back();  // the blank line after the last section
  return out;
}

std::vector<std::string> scene_differences(const Problem& first, const Problem& second, std::string_view there, std::string_view here) {
  std::vector<std::string> differences;
  if (first.cells.size() != second.cells.size())
    differences.push_back(fmt::format("{} [[cells]] {}, {} {}", first.cells.size(), there, second.cells.size(), here));
  Problem a = first, b = second;
  CellSpec none;
  const auto compare = [&](const scene::Key& key, const std::string& path, CellSpec& x, CellSpec& y) {
    const std::string before = scene::value_text(key, key.field(a, x)), now = scene::value_text(key, key.field(b, y));
    const auto shown = [](const std::string& value) { return value.empty() ? std::string("(not set)") : value; };
    if (before != now) differences.push_back(fmt::format("{} = {} {}, {} {}", path, shown(before), there, shown(now), here));
  };
  for (const scene::Key& key : scene::keys()) {
    if (!key.name.starts_with("cells.")) {
      compare(key, std::string(key.name), none, none);
      continue;
    }
    for (std::size_t i = 0; i < std::min(a.cells.size(), b.cells.size()); ++i)
      compare(key, fmt::format("cells.{}{}", i, key.name.substr(std::string_view("cells.*").size())), a.cells[i], b.cells[i]);
  }
  return differences;
}

std::string scene_value(const Problem& problem, const std::string& key) {
  const scene::Key* known = scene::find_key(scene::pattern_of(key));
  if (known == nullptr) throw InputError(fmt::format("{} isn't a key of a scene", key));
  Problem copy = problem;
  CellSpec none;
  if (!key.starts_with("cells.")) return scene::value_text(*known, known->field(copy, none));
  const std::size_t type = std::strtoull(key.c_str() + std::string_view("cells.").size(), nullptr, 10);
  if (type >= copy.cells.size()) throw InputError(fmt::format("{}: the scene has no such cell type", key));
  return scene::value_text(*known, known->field(copy, copy.cells[type]));
}

std::string scene_key_reference() {
  std::string out;
  std::string_view section;
  Problem problem;
  CellSpec cell;
  for (const scene::Key& key : scene::keys()) {
    if (key.section() != section) {
      section = key.section();
      const std::string title = section == "cells.*" ? "[[cells]]" : section.starts_with("cells.*.") ? fmt::format("[[cells]] {}", section.substr(8)) : fmt::format("[{}]", section);
      out += fmt::format("{}### {}\n\n| key | type | default | allowed | unit | meaning |\n|---|---|---|---|---|---|\n", out.empty() ? "" : "\n", title);
    }
    std::string default_text(key.default_note);
    if (default_text.empty()) default_text = fmt::format("`{}`", scene::value_text(key, key.field(problem, cell)));
    std::string unit(key.unit);
    if (const scene::SiKey* si = scene::find_si_key(key.name)) unit += fmt::format("{}{}", unit.empty() ? "" : ", or SI: ", si->unit);
    out += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", key.leaf(), scene::type_name(key), default_text, scene::allowed_text(key), unit, key.meaning);
  }
  return out;
}

std::vector<std::string> scene_key_names() {
  std::vector<std::string> names;
  for (const scene::Key& key : scene::keys()) names.emplace_back(key.name);
  return names;
}

}  // namespace corpuscle
