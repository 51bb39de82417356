#include "io/quantity.hpp"

#include <charconv>
#include <cmath>
#include <string>

namespace corpuscle {
namespace {

// Powers of ten stay integers until the end: 5 / 1e6 is the double nearest to 5e-6, 5 * 1e-6 is not.
struct Unit {
  std::string_view name;
  int power;
  Dimension dimension;
};
constexpr Unit units[] = {{"m", 0, {0, 1, 0}},  {"g", -3, {1, 0, 0}},  {"s", 0, {0, 0, 1}},   {"N", 0, {1, 1, -2}},   {"Pa", 0, {1, -1, -2}},
                          {"J", 0, {1, 2, -2}}, {"Hz", 0, {0, 0, -1}}, {"P", -1, {1, -1, -1}}, {"dyn", -5, {1, 1, -2}}};
struct Prefix {
  std::string_view name;
  int power;
};
// The micro sign and the Greek letter look the same.
constexpr Prefix prefixes[] = {{"", 0},        {"f", -15},     {"p", -12}, {"n", -9}, {"u", -6}, {"\u00b5", -6},
                               {"\u03bc", -6}, {"m", -3},      {"c", -2},  {"k", 3},  {"M", 6}};

struct Factor {
  int power = 0;
  Dimension dimension{};
};

/// "uN" or "m^2", without its sign in the product.
std::optional<Factor> parse_factor(std::string_view text) {
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
      Factor factor{(prefix.power + unit.power) * exponent, unit.dimension};
      for (int& d : factor.dimension) d *= exponent;
      return factor;
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
  int factors = 0, power = 0;
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
    power += divide ? -factor->power : factor->power;
    for (std::size_t i = 0; i < 3; ++i) result.dimension[i] += (divide ? -1 : 1) * factor->dimension[i];
    ++factors;
  }
  if (factors == 0) return std::nullopt;
  result.value = power < 0 ? result.value / std::pow(10.0, -power) : result.value * std::pow(10.0, power);
  if (!std::isfinite(result.value)) return std::nullopt;
  return result;
}

}  // namespace corpuscle
