#include "io/quantity.hpp"

#include <charconv>
#include <cmath>
#include <string>

namespace corpuscle {
namespace {

struct Unit {
  std::string_view name;
  double value;
  Dimension dimension;
};
constexpr Unit units[] = {{"m", 1, {0, 1, 0}},      {"g", 1e-3, {1, 0, 0}},   {"s", 1, {0, 0, 1}},    {"N", 1, {1, 1, -2}},  {"Pa", 1, {1, -1, -2}},
                          {"J", 1, {1, 2, -2}},     {"Hz", 1, {0, 0, -1}},    {"P", 0.1, {1, -1, -1}}, {"dyn", 1e-5, {1, 1, -2}}};
struct Prefix {
  std::string_view name;
  double value;
};
// The micro sign and the Greek letter look the same.
constexpr Prefix prefixes[] = {{"", 1},           {"f", 1e-15}, {"p", 1e-12}, {"n", 1e-9}, {"u", 1e-6},
                               {"\u00b5", 1e-6}, {"\u03bc", 1e-6}, {"m", 1e-3}, {"c", 1e-2}, {"k", 1e3}, {"M", 1e6}};

/// "uN" or "m^2", without its sign in the product.
std::optional<Quantity> parse_factor(std::string_view text) {
  int exponent = 1;
  if (const std::size_t hat = text.find('^'); hat != std::string_view::npos) {
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data() + hat + 1, end, exponent);
    if (error != std::errc{} || rest != end || std::abs(exponent) > 9) return std::nullopt;
    text = text.substr(0, hat);
  }
  for (const Prefix& prefix : prefixes) {
    if (!text.starts_with(prefix.name)) continue;
    for (const Unit& unit : units) {
      if (text.substr(prefix.name.size()) != unit.name) continue;
      Quantity q{std::pow(prefix.value * unit.value, exponent), unit.dimension};
      for (int& d : q.dimension) d *= exponent;
      return q;
    }
  }
  return std::nullopt;
}

/// Length in bytes of the separator that `text` starts with; 0: none.
std::size_t separator(std::string_view text) {
  if (text.starts_with(' ') || text.starts_with('*')) return 1;
  return text.starts_with("\u00b7") ? 2 : 0;
}

}  // namespace

std::optional<Quantity> parse_quantity(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  Quantity result;
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), result.value);
  if (error != std::errc{} || !std::isfinite(result.value)) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  int factors = 0;
  for (bool divide = false; !text.empty();) {
    if (const std::size_t length = separator(text); length > 0) {
      text.remove_prefix(length);
      continue;
    }
    if (text.starts_with('/')) {
      if (divide) return std::nullopt;  // a/b/c is read in two ways
      divide = true;
      text.remove_prefix(1);
      continue;
    }
    std::size_t length = 0;
    while (length < text.size() && text[length] != '/' && separator(text.substr(length)) == 0) ++length;
    const std::string_view name = text.substr(0, length);
    text.remove_prefix(length);
    if (name == "1" && factors == 0 && !divide) continue;  // "100 1/s"
    const auto factor = parse_factor(name);
    if (!factor) return std::nullopt;
    result.value *= divide ? 1 / factor->value : factor->value;
    for (std::size_t i = 0; i < 3; ++i) result.dimension[i] += (divide ? -1 : 1) * factor->dimension[i];
    ++factors;
  }
  if (factors == 0) return std::nullopt;
  return result;
}

}  // namespace corpuscle
