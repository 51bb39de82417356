// Numbers in messages that offer the user a limit.
#pragma once
#include <fmt/format.h>

#include <cmath>
#include <string>

namespace corpuscle {

inline constexpr double limit_tolerance = 1e-8;  ///< limits are met to rounding: 1.2/6 isn't 0.2 in binary

/// Rounded to five digits, never beyond `value`: a limit that a message offers must itself be accepted.
inline std::string at_most(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - 4);
  return fmt::format("{:.5g}", std::floor(value / unit * (1 + limit_tolerance / 2)) * unit);
}
inline std::string at_least(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - 4);
  return fmt::format("{:.5g}", std::ceil(value / unit * (1 - limit_tolerance / 2)) * unit);
}

}  // namespace corpuscle
