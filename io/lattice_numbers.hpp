// The numbers of a lattice under the names that run.h5 and `corpuscle plan --json` give them (docs/outputs.md); lattice units.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "physics/units.hpp"

namespace corpuscle {

using NamedNumbers = std::vector<std::pair<const char*, double>>;
using NamedIntegers = std::vector<std::pair<const char*, std::int64_t>>;

/// Those that no cadence is: lengths, rates, fractions, steps_per_strain, and the SI units where the scene gives them.
NamedNumbers named_numbers(const LatticeParameters& lattice);

NamedNumbers named_numbers(const CellTypeLattice& type);
NamedIntegers named_integers(const CellTypeLattice& type);

}  // namespace corpuscle
