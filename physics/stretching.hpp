// External forces that stretch cells between two ends, as optical tweezers pull a red cell by two beads (Dao, Lim, Suresh, J. Mech. Phys. Solids 51, 2259
// (2003); Mills, Qie, Dao, Lim, Suresh, Mech. Chem. Biosyst. 1, 169 (2004)): +F on the vertices of one contact patch, -F on those of the opposite one.
#pragma once
#include <vector>

#include "core/types.hpp"
#include "physics/cells.hpp"

namespace corpuscle {

/// Adds the stretching forces of all cells that have them. The forces of a cell are constant, their sum is zero.
class Stretching {
 public:
  /// @param types of the scene's cells; those without a force cost nothing
  Stretching(const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types);

  static bool needed(const Problem& problem);

  /// forces += the share of each pulled vertex. forces [V][3], lattice units.
  void add_forces(const VertexVectors& forces) const;

  std::size_t bytes() const;

 private:
  struct Pulled {
    int first_vertex, vertices, cells;
    Array1<int> vertex;    ///< number in the cell
    VertexVectors force;   ///< on this vertex
  };
  std::vector<Pulled> types_;
};

}  // namespace corpuscle
