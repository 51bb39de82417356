// Directory names of the points of a sweep.
#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "io/sweep.hpp"

namespace corpuscle {
namespace {

/// Symbols of the field for keys that are varied often.
constexpr std::array<std::pair<std::string_view, std::string_view>, 8> symbols{{{"capillary_number", "Ca"},
                                                                                {"capillary_number_G", "CaG"},
                                                                                {"effective_volume_fraction", "phi"},
                                                                                {"volume_fraction", "phi"},
                                                                                {"reynolds_number_max", "Re"},
                                                                                {"relaxation_time", "tau"},
                                                                                {"relative_stiffness", "stiffness"},
                                                                                {"count", "N"}}};

/// From short to unmistakable: the symbol, the name within its table, the whole key.
std::array<std::string, 3> labels(const std::string& key) {
  const std::string leaf = key.substr(key.rfind('.') + 1);
  const auto symbol = std::find_if(symbols.begin(), symbols.end(), [&](const auto& s) { return s.first == leaf; });
  const bool further_type = key.starts_with("cells.") && !key.starts_with("cells.0.");
  const std::string type = further_type ? "cells" + key.substr(6, key.find('.', 6) - 6) + "." : "";
  return {type + (symbol == symbols.end() ? leaf : std::string(symbol->second)), type + leaf, key};
}

/// A value as a part of a file name.
std::string plain(const std::string& value) {
  std::string text;
  bool list = value.starts_with('[');
  for (std::size_t i = 0; i < value.size(); ++i) {
    const char c = value[i];
    if (c == '"' || c == '[' || c == ']' || (list && c == ' ')) continue;
    const bool fits = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '.' || c == '-' || c == '+' || c == '_';
    text += list && c == ',' ? 'x' : fits ? c : '_';
  }
  return text;
}

}  // namespace

std::vector<std::string> sweep_names(const std::vector<std::vector<Override>>& given) {
  std::vector<std::string> keys;
  std::map<std::string, std::set<std::string>> values;
  std::map<std::string, std::size_t> points_with;
  for (const auto& point : given)
    for (const Override& o : point) {
      if (!values.contains(o.key)) keys.push_back(o.key);
      values[o.key].insert(o.value);
      ++points_with[o.key];
    }
  std::erase_if(keys, [&](const std::string& key) { return values[key].size() == 1 && points_with[key] == given.size(); });

  std::array<std::map<std::string, int>, 3> times;  // how often each label of each kind is there
  for (const std::string& key : keys)
    for (std::size_t level = 0; level < 3; ++level) ++times[level][labels(key)[level]];
  struct Varying {
    std::size_t place;
    std::string label;
  };
  std::map<std::string, Varying> varying;
  for (std::size_t place = 0; place < keys.size(); ++place) {
    const auto choices = labels(keys[place]);
    const std::size_t level = times[0][choices[0]] == 1 ? 0 : times[1][choices[1]] == 1 ? 1 : 2;
    varying[keys[place]] = {place, choices[level]};
  }

  std::vector<std::string> names;
  for (const auto& point : given) {
    std::map<std::size_t, std::string> parts;
    for (const Override& o : point) {
      const auto key = varying.find(o.key);
      if (key == varying.end()) continue;
      const std::string value = plain(o.value);
      const bool number = !value.empty() && value[0] >= '0' && value[0] <= '9' && !o.value.starts_with('"');
      parts[key->second.place] = key->second.label + (number ? "" : "_") + value;
    }
    std::string name;
    for (const auto& [place, part] : parts) name += (name.empty() ? "" : "-") + part;
    names.push_back(name.empty() ? "base" : name);
  }
  return names;
}

}  // namespace corpuscle
