// Contact forces between cells and with walls, by neighbour lists with a skin: O(N), rebuilt only when a vertex has moved half the skin. Forces don't depend on when that was.
#pragma once
#include "core/cell_list.hpp"
#include "core/types.hpp"
#include "kernels/contact.hpp"
#include "kernels/stencil.hpp"

namespace corpuscle {

/// Lattice units.
struct ContactParameters {
  double strength = 0;  ///< kappa_int
  double range = 1;     ///< d_0
  double skin = 0.6;    ///< extra reach of the lists
  /// Vertices move by no more than this from one call to the next, or than twice as far as in the calls before: then the test whether the lists still hold is left out for as many
  /// calls as the skin allows. 0: tested at every call.
  double expected_move = 0;
};

/// Vertices of other cells near each vertex: row v is list(begin(v)) ... list(begin(v + 1) - 1), every pair in both rows, ascending.
struct NeighbourRows {
  Array1<int> begin, list;
};

/// Vertices as the search for neighbours sees them: wrapped into the box, in the order of the bins. The host looks at `lanes` of them at once, so that many more are allocated.
struct BinnedVertices {
  static constexpr int lanes = runs_on_host ? 8 : 1;
  Array2<float> place;  ///< [3][V + lanes]
  Array1<int> cell;     ///< [V + lanes]
};

class Contact {
 public:
  /// @param cell_of_vertex [V]; vertices of the same cell do not repel each other (its periodic images do)
  Contact(const PeriodicBox& box, const ContactParameters& parameters, const Array1<int>& cell_of_vertex);

  /// Adds the repulsion to `forces` ([V][3], lattice units). @throws SimulationError where thousands of vertices lie in one place: the state is broken
  void add_forces(const VertexVectors& positions, const VertexVectors& forces);

  /// Smallest distance between vertices of different cells among those within the range of the lists; the range plus skin if there are none.
  double smallest_gap(const VertexVectors& positions);

  const NeighbourRows& neighbours() const { return rows_; }
  const Array1<int>& cell_of_vertex() const { return cell_of_vertex_; }
  const ContactParameters& parameters() const { return parameters_; }
  std::int64_t rebuilds() const { return rebuilds_; }
  std::size_t bytes() const;

 private:
  void update_lists(const VertexVectors& positions);
  bool lists_hold(const VertexVectors& positions);

  PeriodicBox box_;
  ContactParameters parameters_;
  Array1<int> cell_of_vertex_, first_vertex_, keys_;
  BinGrid grid_;
  CellList bins_;
  NeighbourRows rows_;
  BinnedVertices binned_;
  VertexVectors built_at_;
  std::int64_t rebuilds_ = 0;
  // Since the lists were built: calls, number of the last and of the next test, what the fastest vertex had moved at the last test.
  int calls_ = 0, tested_at_ = 0, next_test_ = 1;
  double moved_before_ = 0;
};

}  // namespace corpuscle
