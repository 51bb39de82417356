#include "io/scene_toml.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/error.hpp"
#include "io/scene_keys.hpp"

namespace corpuscle::scene {

namespace {

/// Keys of which a scene gives at most one: an override of one removes the others that come from the file.
const std::vector<std::vector<std::string_view>> alternatives = {
    {"cells.*.count", "cells.*.volume_fraction", "cells.*.effective_volume_fraction"},
    {"flow.capillary_number", "flow.capillary_number_G", "si.shear_rate"},
    {"run.strain", "run.steps", "run.duration"},
    {"cells.*.shape", "cells.*.file"},
};
/// What an override of the preset or the target takes over from the file (the preset the precision, too): without this `--set accuracy.preset=draft` had no effect on a merged scene.
constexpr std::array<std::string_view, 6> resolution_knobs = {"radius", "subdivision", "delta_kernel", "collision", "magic_parameter", "relaxation_time"};

bool valid_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const int more = lead < 0x80 ? 0 : lead >> 5 == 6 ? 1 : lead >> 4 == 14 ? 2 : lead >> 3 == 30 ? 3 : -1;
    if (more < 0 || i + more >= text.size()) return false;
    for (int k = 1; k <= more; ++k) {
      if (static_cast<unsigned char>(text[i + k]) >> 6 != 2) return false;
    }
    i += 1 + more;
  }
  return true;
}

/// Position of the first non-ASCII character outside of strings and comments, where TOML allows none, or first behind the backslash that
/// continues a line of a string; npos if there is none. toml++ 3.3 runs into undefined behaviour on some of them instead of reporting them.
std::size_t stray_character(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
    } else if (c == '"' || c == '\'') {
      const bool multi_line = text.substr(i, 3) == std::string(3, c);
      const std::string_view end = text.substr(i, multi_line ? 3 : 1);
      for (i += end.size(); i < text.size() && text.substr(i, end.size()) != end && (multi_line || text[i] != '\n'); ++i) {
        if (c != '"' || text[i] != '\\') continue;
        ++i;
        if (!multi_line || i >= text.size() || std::string_view(" \t\r\n").find(text[i]) == std::string_view::npos) continue;
        // A line that goes on in the next one: toml++ asks whether what comes there is a blank, and trips over the same characters.
        i = std::min(text.find_first_not_of(" \t\r\n", i), text.size());
        if (i < text.size() && static_cast<unsigned char>(text[i]) >= 0x80) return i;
        --i;
      }
      i += end.size() - 1;
      // A string of several lines may end in one or two quotes of its own.
      for (int own = 0; multi_line && own < 2 && i + 1 < text.size() && text[i + 1] == c; ++own) ++i;
    } else if (static_cast<unsigned char>(c) >= 0x80) {
      return i;
    }
  }
  return std::string_view::npos;
}

/// toml::parse without its undefined behaviour: it must not see a non-ASCII character outside of strings and comments, and where a string
/// begins is only certain in valid TOML. So a copy in ASCII is parsed first; with that accepted, stray_character() has told the truth.
toml::table parse_toml(std::string_view text) {
  std::string ascii(text);
  std::replace_if(ascii.begin(), ascii.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x80; }, 'x');
  if (ascii != text) (void)toml::parse(ascii);
  return toml::parse(text);
}

/// Line with more nested tables than any scene has, in dotted keys or headers; 0 if there is none. toml++ bounds the depth of brackets but
/// not of dotted keys, and destroys a table by recursion: 100 000 dots overflow the stack.
std::ptrdiff_t too_deep_line(std::string_view text) {
  constexpr std::ptrdiff_t most_dots = 500;
  for (std::ptrdiff_t line = 1; !text.empty(); ++line) {
    const std::string_view content = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(content.size() + 1, text.size()));
    // Strings and comments are counted too: none in a scene is a sentence of 500 parts.
    if (std::count(content.begin(), content.end(), '.') > most_dots) return line;
  }
  return 0;
}

std::vector<std::string> split(std::string_view path) {
  std::vector<std::string> parts;
  for (std::size_t start = 0;;) {
    const std::size_t dot = path.find('.', start);
    parts.emplace_back(path.substr(start, dot == std::string_view::npos ? dot : dot - start));
    if (dot == std::string_view::npos) return parts;
    start = dot + 1;
  }
}

bool is_number(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// The value of an override as a table {v = value}; what isn't one TOML value is a bare string.
toml::table override_value(const std::string& text) {
  const std::string assignment = "v = " + text;
  if (text.find_first_of("\r\n") == std::string::npos && stray_character(assignment) == std::string::npos && valid_utf8(text) && too_deep_line(text) == 0) {
    try {
      toml::table parsed = parse_toml(assignment);
      if (parsed.size() == 1) return parsed;
    } catch (const toml::parse_error&) {  // bare string, below
    }
  }
  return toml::table{{"v", text}};
}

/// The table that holds the last part of `path`; sections the file leaves out are created.
toml::table& parent_table(Document& document, const std::string& path, const std::vector<std::string>& parts) {
  toml::node* node = &document.root;
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
    if (toml::array* array = node->as_array()) {
      std::size_t index = array->size();
      std::from_chars(parts[i].data(), parts[i].data() + parts[i].size(), index);
      if (index >= array->size()) {
        throw InputError(fmt::format("--set: {}: there is no cell type {}, the scene has {} [[cells]] (numbered from 0)", one_line(path), parts[i], array->size()));
      }
      node = array->get(index);
    } else if (toml::table* table = node->as_table()) {
      if (!table->contains(parts[i])) {
        if (parts[i] == "cells") throw InputError(fmt::format("--set: {}: the scene has no [[cells]]; add a cell type to the file first", one_line(path)));
        table->insert(parts[i], toml::table{});
      }
      node = table->get(parts[i]);
    } else {
      break;
    }
  }
  toml::table* table = node->as_table();
  if (table == nullptr) throw InputError(fmt::format("--set: {}: the scene gives a single value where this key needs a table; correct the scene first", one_line(path)));
  return *table;
}

void apply_override(Document& document, const std::string& text) {
  const std::size_t equals = text.find('=');
  const auto trim = [](std::string s) {
    s.erase(0, s.find_first_not_of(" \t"));
    s.erase(s.find_last_not_of(" \t") + 1);
    return s;
  };
  const std::string path = trim(text.substr(0, equals));
  if (equals == std::string::npos || path.empty()) {
    throw InputError(fmt::format("--set: {} isn't of the form key=value, for instance flow.capillary_number=0.05", quote(one_line(text))));
  }
  const std::string pattern = pattern_of(path);
  if (find_key(pattern) == nullptr && !(is_section(pattern) && pattern.starts_with("cells.*."))) {
    throw InputError(fmt::format("--set: {} isn't a key of a scene; the nearest known key is {}", one_line(path), nearest_key(pattern)));
  }
  const std::vector<std::string> parts = split(path);
  toml::table& table = parent_table(document, path, parts);
  toml::table value = override_value(trim(text.substr(equals + 1)));
  table.insert_or_assign(parts.back(), std::move(*value.get("v")));
  document.overridden.insert(path);
}

/// Removes from the file what an override replaces.
void drop_replaced(Document& document) {
  for (const std::string& path : document.overridden) {
    const std::string pattern = pattern_of(path);
    const std::string section = path.substr(0, path.rfind('.') + 1);  // "cells.0." with its dot
    const auto drop = [&](const std::string& other) {
      const std::vector<std::string> parts = split(other);
      if (document.overridden.contains(other) || (parts.size() == 2 && !document.root.contains(parts[0]))) return;
      parent_table(document, other, parts).erase(parts.back());
    };
    for (const auto& group : alternatives) {
      if (std::find(group.begin(), group.end(), pattern) == group.end()) continue;
      for (const std::string_view other : group) {
        if (other != pattern) drop(other.starts_with("cells.") ? section + std::string(other.substr(other.rfind('.') + 1)) : std::string(other));
      }
    }
    if (pattern == "accuracy.preset" || pattern == "accuracy.target")
      for (const std::string_view knob : resolution_knobs) drop(section + std::string(knob));
    if (pattern == "accuracy.preset") drop(section + "precision");
  }
}

}  // namespace

std::string read_text(const std::string& path, std::string_view kind) {
  constexpr std::size_t largest = 4u << 20;  // no scene is that long; keeps devices and data files from being read whole
  const std::string name = one_line(path, 300);
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw InputError(fmt::format("{}: there is no such {} file; check the path", name, kind));
  if (std::filesystem::is_directory(path, ignored)) throw InputError(fmt::format("{}: is a directory, not a {} file; name the .toml file in it", name, kind));
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("{}: the {} file can't be opened for reading; check its permissions", name, kind));
  std::string text(largest + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > largest) throw InputError(fmt::format("{}: is longer than 4 MiB, so it isn't a {} file; see docs/{}.md", name, kind, kind));
  return text;
}

toml::table parse_table(std::string_view text, const std::string& origin, std::string_view expected) {
  const std::size_t zero = text.find('\0');
  if (zero != std::string_view::npos || !valid_utf8(text)) throw InputError(fmt::format("{}: isn't a text file (TOML in UTF-8); {}", origin, expected));
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte-order mark of some editors
  if (const std::size_t stray = stray_character(text); stray != std::string_view::npos) {
    const std::string_view rest = text.substr(stray);
    std::size_t length = 1;
    while (length < rest.size() && static_cast<unsigned char>(rest[length]) >> 6 == 2) ++length;
    throw InputError(fmt::format("{}:{}: isn't valid TOML: the character '{}' may only stand inside quotes or in a comment, "
                                 "and not where a line goes on after a backslash",
                                 origin, 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(stray), '\n'), rest.substr(0, length)));
  }
  if (const std::ptrdiff_t line = too_deep_line(text); line > 0) {
    throw InputError(fmt::format("{}:{}: has more than 500 dots in one line, which no key of a scene needs; correct the line, or break a long list", origin, line));
  }
  try {
    return parse_toml(text);
  } catch (const toml::parse_error& error) {
    throw InputError(fmt::format("{}:{}: isn't valid TOML at column {}: {}", origin, error.source().begin.line, error.source().begin.column, one_line(error.description(), 300)));
  }
}

Document parse_document(std::string_view text, const std::string& origin, const std::vector<std::string>& overrides) {
  Document document;
  document.origin = one_line(origin, 300);
  document.root = parse_table(text, document.origin, "a scene starts with tables such as [box] and [flow], see docs/scene.md");
  if (document.root.empty()) {
    throw InputError(fmt::format("{}: the scene is empty; it needs at least [box] and [flow], see docs/scene.md", document.origin));
  }
  for (const std::string& text_of_override : overrides) apply_override(document, text_of_override);
  drop_replaced(document);
  return document;
}

std::string where(const Document& document, const std::string& path, const toml::node* node) {
  for (const std::string& set : document.overridden) {
    if (path == set || path.starts_with(set + ".")) return "--set: ";
  }
  if (node == nullptr || node->source().begin.line == 0) return document.origin + ": ";
  return fmt::format("{}:{}: ", document.origin, node->source().begin.line);
}

std::string one_line(std::string_view text, std::size_t longest) {
  std::string out;
  for (const char c : text) {
    if (out.size() >= longest && (static_cast<unsigned char>(c) >> 6) != 2) return out + "...";  // never inside a UTF-8 sequence
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) out += out.empty() || out.back() == ' ' ? "" : " ";
    else out += c;
  }
  return out;
}

std::string shown(const toml::node& node) {
  if (node.is_table()) return "a table";
  if (const auto* text = node.as_string()) return quote(one_line(text->get()));
  if (const auto* value = node.as_floating_point()) return fmt::format("{}", value->get());  // shortest form; toml++ prints 0.84999999999999998
  if (const auto* list = node.as_array()) {
    std::string text;
    for (std::size_t i = 0; i < list->size() && text.size() < 60; ++i) text += (i ? ", " : "") + shown(*list->get(i));
    return one_line("[" + text + "]");
  }
  std::ostringstream out;
  node.visit([&](const auto& value) { out << value; });
  return one_line(out.str());
}

void refuse(const std::string& origin, std::ptrdiff_t line, const std::string& problem) {
  throw InputError(line == 0 ? fmt::format("{}: {}", origin, problem) : fmt::format("{}:{}: {}", origin, line, problem));
}

void allow_only(const std::string& origin, const toml::table& table, std::span<const std::string_view> known, const char* of) {
  for (const auto& [name, node] : table)
    if (std::find(known.begin(), known.end(), name.str()) == known.end())
      refuse(origin, node.source().begin.line, fmt::format("{} isn't a key of {}; allowed: {}; the nearest is {}", one_line(name.str()), of, fmt::join(known, ", "), nearest(name.str(), known)));
}

std::string pattern_of(std::string_view path) {
  std::string pattern;
  const std::vector<std::string> parts = split(path);
  for (std::size_t i = 0; i < parts.size(); ++i) pattern += (i ? "." : "") + (i == 1 && parts[0] == "cells" && is_number(parts[i]) ? "*" : parts[i]);
  return pattern;
}

}  // namespace corpuscle::scene
