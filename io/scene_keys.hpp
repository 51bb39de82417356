// The one table of scene keys. Reading, range checks, messages, suggestions, to_toml and the reference in docs/scene.md all follow from it:
// a new key is one line in scene_keys.cpp (and its member in physics/problem.hpp).
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "physics/problem.hpp"

namespace corpuscle::scene {

/// Where a key's value lives in a Problem; its type is the key's type.
using Field = std::variant<bool*, int*, std::optional<int>*, std::optional<std::int64_t>*, std::uint64_t*, double*, std::optional<double>*,
                           std::array<double, 3>*, std::optional<std::array<double, 3>>*, std::string*, FlowKind*, ShapeKind*, StrainLawKind*,
                           CollisionKind*, Precision*, VertexUpdate*, CellSize*, CountedShell*>;

/// Allowed interval of a number (of every component of a triple).
struct Range {
  double low = -std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::max();
  bool low_open = false;
  bool high_open = false;
  bool contains(double value) const;
  std::string text() const;  ///< "> 0 and <= 100"
};

/// One key. `name` is dotted, with `*` for the number of the cell type.
struct Key {
  std::string_view name;
  Field (*field)(Problem&, CellSpec&);
  Range range;
  std::string_view choices;       ///< "shear|poiseuille|rest", in the order of the enumeration; empty when free
  std::string_view unit;
  std::string_view default_note;  ///< replaces the constant default where the default is computed, or the key is required
  std::string_view meaning;
  std::string_view section() const { return name.substr(0, name.rfind('.')); }
  std::string_view leaf() const { return name.substr(name.rfind('.') + 1); }
};

/// All keys, grouped by section in the order of the reference.
std::span<const Key> keys();
const Key* find_key(std::string_view name);
bool is_section(std::string_view name);
/// "cells.0.membrane.law" -> "cells.*.membrane.law", the name in the table of keys.
std::string pattern_of(std::string_view path);

/// "number", "whole number", "true or false", "string", "3 numbers" …
std::string type_name(const Key& key);
std::vector<std::string_view> choice_list(const Key& key);

/// The value in TOML syntax; empty for an optional that isn't set.
std::string value_text(const Key& key, const Field& field);
std::string quote(std::string_view text);

/// Damerau-Levenshtein distance (adjacent transpositions count one, restricted form).
int edit_distance(std::string_view a, std::string_view b);
std::string_view nearest(std::string_view word, std::span<const std::string_view> candidates);
/// The known key nearest to an unknown one; a key of the same section is preferred.
std::string_view nearest_key(std::string_view name);

/// Sets the knobs that a preset stands for.
void apply_preset(AccuracySpec& accuracy, std::string_view preset);
/// Whether a key has a meaning in this scene (aspect_ratio only for spheroids …); if not, `reason` says when it has.
bool applies(const Key& key, const Problem& problem, const CellSpec& cell, std::string& reason);

}  // namespace corpuscle::scene
