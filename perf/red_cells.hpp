// The suspensions that benchmarks run on: red cells at random places, or packed. One packed block is repeated where a whole box would take long to pack: to
// every operator its copies are cells like others.
#pragma once
#include <array>
#include <vector>

#include "physics/cells.hpp"
#include "physics/problem.hpp"

namespace corpuscle::perf {

/// What a case varies. Lattice units.
struct SuspensionSettings {
  std::array<int, 3> nodes{128, 128, 128};
  double phi = 0.36;  ///< geometric volume fraction
  double radius = 8;
  int subdivision = 8;  ///< 10 n^2 + 2 vertices
  int points = 4;
  bool walls = true;
  Precision precision = Precision::single_precision, membrane = Precision::double_precision;
};

/// The dense suspension that most sections use: 946 red cells of 642 vertices; a tiny one in a quick run.
SuspensionSettings usual_settings(bool quick);

/// Sheared between walls at Ca = 0.1, or at rest without walls.
struct SuspensionCase {
  Problem problem;
  LatticeParameters lattice;
  std::vector<CellType> types;
  std::vector<double> positions;

  int cells() const { return types[0].count; }
  double vertices() const { return double(types[0].count) * types[0].vertices(); }
  double nodes() const { return lattice.box_volume(); }
};

/// Everything but the positions.
SuspensionCase suspension_case(const SuspensionSettings& settings);

/// Random places and orientations; centres in the layer z_from ... z_to of the height. The cells overlap: contact is switched off.
SuspensionCase random_suspension(const SuspensionSettings& settings, double z_from = 0, double z_to = 1);

/// Packs settings.nodes/copies once and repeats it `copies` times along each axis.
SuspensionCase packed_suspension(const SuspensionSettings& settings, std::array<int, 3> copies);

/// The same places with other precision, kernel or membrane.
SuspensionCase with_positions_of(const SuspensionCase& packed, const SuspensionSettings& settings);

}  // namespace corpuscle::perf
