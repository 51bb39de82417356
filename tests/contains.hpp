#pragma once
// Contains("text"): the substring matcher under one name; Catch2 3 calls it ContainsSubstring.
#include <string>

#include "tests/catch.hpp"

#if __has_include(<catch2/catch_all.hpp>)
inline auto Contains(const std::string& text) { return Catch::Matchers::ContainsSubstring(text); }
#else
using Catch::Matchers::Contains;
#endif
