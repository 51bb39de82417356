// TOML text and overrides to one table, and where each of its values came from. Only io/scene*.cpp and io/sweep.cpp include this (toml++ is slow to compile).
#pragma once
// toml++ 3.3 asserts where it then copes: a date followed by a space and a character ("x = 1979-05-27 1") would abort a debug build.
#define TOML_ASSERT(expression) static_cast<void>(0)
#include <toml++/toml.h>

#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace corpuscle::scene {

/// A parsed scene with the overrides merged in.
struct Document {
  toml::table root;
  std::string origin;                ///< named in messages
  std::set<std::string> overridden;  ///< display paths ("cells.0.count") set on the command line
};

/// The whole text of a small file. `kind` ("scene", "sweep") names it in messages and its page in docs/. @throws InputError when it can't be read or is no such file.
std::string read_text(const std::string& path, std::string_view kind);

/// @param expected what such a file looks like, for messages: "a scene starts with tables such as [box] and [flow], see docs/scene.md"
/// @throws InputError for what isn't valid TOML
toml::table parse_table(std::string_view text, const std::string& origin, std::string_view expected);

/// @throws InputError for bad TOML, an empty scene, a malformed override or one whose key doesn't exist.
Document parse_document(std::string_view text, const std::string& origin, const std::vector<std::string>& overrides);

/// "scene.toml:12: " or "--set: ", the start of every message about a value.
std::string where(const Document& document, const std::string& path, const toml::node* node = nullptr);

/// @throws InputError "ORIGIN:LINE: PROBLEM", without the line where that is 0
[[noreturn]] void refuse(const std::string& origin, std::ptrdiff_t line, const std::string& problem);
/// @throws InputError when a table has a key that isn't known, with the nearest one. `of`: "[[axis]]"
void allow_only(const std::string& origin, const toml::table& table, std::span<const std::string_view> known, const char* of);

/// A value on one line, shortened, without control characters: safe inside a message.
std::string shown(const toml::node& node);
std::string one_line(std::string_view text, std::size_t longest = 60);

}  // namespace corpuscle::scene
