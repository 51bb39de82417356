#include "io/scene.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <type_traits>

#include "core/error.hpp"
#include "io/scene_check.hpp"
#include "io/scene_keys.hpp"
#include "io/scene_si.hpp"
#include "io/scene_toml.hpp"

namespace corpuscle {

namespace scene {

namespace {

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};

/// Each type has a mesh of its own; a file of a few megabytes could ask for a million.
constexpr std::size_t most_cell_types = 1000;

/// Fills a Problem from a Document, one key of the table at a time.
class Reader {
 public:
  explicit Reader(const Document& document) : document_(document) {}

  Problem read() {
    if (const toml::table* accuracy = document_.root["accuracy"].as_table(); accuracy != nullptr && accuracy->contains("preset")) {
      read_value(*find_key("accuracy.preset"), "accuracy.preset", *accuracy->get("preset"), none_);
    }
    apply_preset(problem_.accuracy, std::string(problem_.accuracy.preset));  // before the knobs, which win
    read_table(document_.root, "", none_);
    convert_quantities();
    return std::move(problem_);
  }

  Given take_given() { return std::move(given_); }

 private:
  void read_table(const toml::table& table, const std::string& prefix, CellSpec& cell) {
    for (const auto& [name, node] : table) {
      const std::string path = prefix + std::string(name.str());
      const std::string pattern = pattern_of(path);
      // A quoted key with a dot in it would look like a key of another table.
      if (name.str().find('.') != std::string_view::npos) fail(path, node, fmt::format("isn't a key of a scene; the nearest known key is {}, written without quotes", nearest_key(pattern)));
      if (path == "cells") read_cells(node);
      else if (const Key* key = find_key(pattern)) read_value(*key, path, node, cell);
      else if (is_section(pattern)) {
        if (!node.is_table()) fail(path, node, fmt::format("= {} must be a table: write [{}] and its keys below", shown(node), path));
        read_table(*node.as_table(), path + ".", cell);
      } else {
        fail(path, node, fmt::format("isn't a key of a scene; the nearest known key is {}", nearest_key(pattern)));
      }
    }
  }

  void read_cells(const toml::node& node) {
    const toml::array* types = node.as_array();
    if (types == nullptr) fail("cells", node, "must be a list of tables: write [[cells]] with two brackets for each cell type");
    if (types->size() > most_cell_types) {
      fail("cells", node, fmt::format("lists {} cell types, but at most {} are possible: give cells of one kind one type with a count", types->size(),
                                      most_cell_types));
    }
    problem_.cells.resize(types->size());
    for (std::size_t i = 0; i < types->size(); ++i) {
      const std::string path = fmt::format("cells.{}", i);
      const toml::node& type = *types->get(i);
      if (!type.is_table()) fail(path, type, fmt::format("= {} must be a table: write [[cells]] with two brackets for each cell type", shown(type)));
      read_table(*type.as_table(), path + ".", problem_.cells[i]);
    }
  }

  void read_value(const Key& key, const std::string& path, const toml::node& node, CellSpec& cell) {
    cell_ = &cell;
    std::visit([&](auto* field) { assign(*field, key, path, node); }, key.field(problem_, cell));
    given_[path] = where(document_, path, &node);
  }

  template <class T>
  void assign(T& field, const Key& key, const std::string& path, const toml::node& node) {
    if constexpr (IsOptional<T>::value) assign(field.emplace(), key, path, node);
    else if constexpr (std::is_same_v<T, bool>) field = node.is_boolean() ? node.as_boolean()->get() : wrong_type<bool>(key, path, node);
    else if constexpr (std::is_same_v<T, std::string>) field = text(key, path, node);
    else if constexpr (std::is_enum_v<T>) field = static_cast<T>(choice(key, path, text(key, path, node), node));
    else if constexpr (std::is_integral_v<T>) field = static_cast<T>(whole(key, path, node));
    else if constexpr (std::is_same_v<T, double>) field = number_or_quantity(key, path, node, &field);
    else {
      const toml::array* list = node.as_array();
      if (list == nullptr || list->size() != field.size()) wrong_type<int>(key, path, node);
      for (std::size_t i = 0; i < field.size(); ++i) field[i] = number_or_quantity(key, fmt::format("{}[{}]", path, i), *list->get(i), &field[i]);
    }
  }

  std::string text(const Key& key, const std::string& path, const toml::node& node) {
    if (!node.is_string()) wrong_type<int>(key, path, node);
    std::string value = node.as_string()->get();
    if (!key.choices.empty()) choice(key, path, value, node);
    return value;
  }

  std::size_t choice(const Key& key, const std::string& path, const std::string& value, const toml::node& node) {
    const std::vector<std::string_view> choices = choice_list(key);
    for (std::size_t i = 0; i < choices.size(); ++i) {
      if (choices[i] == value) return i;
    }
    fail(path, node, fmt::format("= {} isn't known; allowed: {}; the nearest is \"{}\"", shown(node), fmt::join(choices, ", "), nearest(value, choices)));
  }

  /// A value with a unit waits until all that its conversion depends on is read.
  double number_or_quantity(const Key& key, const std::string& path, const toml::node& node, double* field) {
    if (node.is_number()) return checked(key, path, node, *node.value<double>());
    const SiKey* si = find_si_key(key.name);
    const auto quantity = node.is_string() && si != nullptr ? parse_quantity(node.as_string()->get()) : std::nullopt;
    if (!quantity) wrong_type<double>(key, path, node);
    if (quantity->dimension != si->dimension) {
      fail(path, node, fmt::format("= {} has another dimension: it must be in {}, such as \"{}\"", shown(node), si->unit, si->example));
    }
    waiting_.push_back({&key, si, path, &node, cell_, field, quantity->value});
    return 0;
  }

  void convert_quantities() {
    std::stable_partition(waiting_.begin(), waiting_.end(), [](const Waiting& w) { return w.key->section() == "si" || w.si->first; });
    std::stable_partition(waiting_.begin(), waiting_.end(), [](const Waiting& w) { return w.key->section() == "si"; });
    for (const Waiting& w : waiting_) {
      std::string missing;
      const double scale = w.si->scale(problem_, *w.cell, missing);
      if (!missing.empty()) fail(w.path, *w.node, fmt::format("= {} needs {} to be converted: give it, or a number without a unit", shown(*w.node), missing));
      *w.field = checked(*w.key, w.path, *w.node, w.value / scale);
    }
  }

  std::int64_t whole(const Key& key, const std::string& path, const toml::node& node) {
    if (node.is_integer()) {
      const std::int64_t value = node.as_integer()->get();
      checked(key, path, node, static_cast<double>(value));
      return value;
    }
    if (!node.is_number()) wrong_type<std::int64_t>(key, path, node);
    const double value = checked(key, path, node, node.as_floating_point()->get());
    // 1e6 is a float in TOML, but a natural way to write a count.
    if (value != std::floor(value) || std::abs(value) > 9e15) wrong_type<std::int64_t>(key, path, node);
    return static_cast<std::int64_t>(value);
  }

  double checked(const Key& key, const std::string& path, const toml::node& node, double value) {
    const bool whole_number = type_name(key) == "whole number";
    const std::string allowed = fmt::format("a {} {}", whole_number ? "whole number" : "number", key.range.text());
    if (node.is_string() && !key.range.contains(value)) {
      const std::string unit = key.unit.empty() ? "in SI units" : std::string(key.unit);
      fail(path, node, fmt::format("= {} is {:.4g} {}, out of range: it must be {}", shown(node), value, unit, allowed));
    }
    if (!std::isfinite(value)) fail(path, node, fmt::format("= {} must be {}", shown(node), allowed));
    if (key.range.contains(value)) return value;
    if (const SiKey* si = find_si_key(key.name); si != nullptr && key.section() == "si") {
      fail(path, node, fmt::format("= {} {} is out of range: it must be {}; or give it with its unit, such as \"{}\"", shown(node), si->unit, allowed, si->example));
    }
    const bool low = value <= key.range.low;
    // An open end has no nearest allowed value to name.
    const std::string hint = low ? (key.range.low_open ? "" : fmt::format("; the nearest allowed value is {}", key.range.low))
                                 : (key.range.high_open ? "" : fmt::format("; the nearest allowed value is {}", key.range.high));
    fail(path, node, fmt::format("= {} is out of range: it must be {}{}", shown(node), allowed, hint));
  }

  template <class T>
  [[noreturn]] T wrong_type(const Key& key, const std::string& path, const toml::node& node) {
    const std::string type = type_name(key);
    const SiKey* si = find_si_key(key.name);
    fail(path, node, fmt::format("= {} must be {}{}{}{}", shown(node), type == "true or false" ? "" : "a ", type,
                                 key.choices.empty() ? "" : fmt::format(", one of: {}", fmt::join(choice_list(key), ", ")),
                                 si == nullptr ? "" : fmt::format(", or a quantity with its unit such as \"{}\"", si->example)));
  }

  [[noreturn]] void fail(const std::string& path, const toml::node& node, const std::string& problem) {
    throw InputError(fmt::format("{}{} {}", where(document_, path, &node), one_line(path, 120), problem));
  }

  /// A value with a unit, to be converted once the scene is read.
  struct Waiting {
    const Key* key;
    const SiKey* si;
    std::string path;
    const toml::node* node;
    const CellSpec* cell;
    double* field;
    double value;  ///< in SI units
  };

  const Document& document_;
  Problem problem_;
  std::vector<Waiting> waiting_;
  CellSpec* cell_ = nullptr;  // of the key that is being read
  CellSpec none_;  // target for keys outside [[cells]], never written
  Given given_;
};

/// Files named in a scene are relative to it; absolute in the Problem, so that a merged scene works from anywhere.
void resolve(std::string& file, const std::string& origin) {
  if (file.empty()) return;
  file = std::filesystem::absolute(std::filesystem::path(origin).parent_path() / file).lexically_normal().string();
}

}  // namespace
}  // namespace scene

Problem parse_scene(std::string_view text, const std::string& origin, const std::vector<std::string>& overrides) {
  const scene::Document document = scene::parse_document(text, origin, overrides);
  scene::Reader reader(document);
  Problem problem = reader.read();
  scene::resolve(problem.run.packing, origin);
  for (CellSpec& cell : problem.cells) scene::resolve(cell.file, origin);
  scene::finish_and_check(problem, reader.take_given(), document.origin);
  return problem;
}

Problem read_scene(const std::string& path, const std::vector<std::string>& overrides) { return parse_scene(scene::read_text(path, "scene"), path, overrides); }

}  // namespace corpuscle
