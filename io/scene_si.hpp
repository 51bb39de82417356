// Keys whose values may be given in SI units: which unit, and what the dimensionless value is relative to.
#pragma once
#include <string>
#include <string_view>

#include "io/quantity.hpp"
#include "io/scene_keys.hpp"

namespace corpuscle::scene {

/// A key that takes SI units.
struct SiKey {
  std::string_view name;
  std::string_view unit;     ///< "N/m", for messages and the reference
  std::string_view example;  ///< "5.3 uN/m"
  Dimension dimension;
  /// SI value of the dimensionless 1, from [si] and the cell type; 0 when something is missing, which `missing` then names.
  double (*scale)(const Problem&, const CellSpec&, std::string& missing);
  bool first = false;        ///< scales of others depend on this one
};

/// Null for keys that have no SI unit.
const SiKey* find_si_key(std::string_view name);

/// Ca = eta_0 shear_rate r / kappa_S of a scene with si.shear_rate. `missing` names what else [si] must give; then 0.
double capillary_number(const SiSpec& si, std::string& missing);

}  // namespace corpuscle::scene
