// Physical quantities as text: "3.91 um", "67.7 pN", "1.2 mPa s", "5.3 uN/m".
#pragma once
#include <array>
#include <optional>
#include <string_view>

namespace corpuscle {

using Dimension = std::array<int, 3>;  ///< exponents of kg, m, s

struct Quantity {
  double value = 0;  ///< in SI units
  Dimension dimension{};
};

/// A number and a unit: factors m, g, s, N, Pa, J, Hz, P (poise), dyn, each with a prefix (f p n u µ m c k M) and an exponent (m^2, s^-1) if needed;
/// separated by spaces, * or ·; what follows a / is divided by: "J/m^2", "1/s". Empty when the text is none.
std::optional<Quantity> parse_quantity(std::string_view text);

}  // namespace corpuscle
