// Guards: a run must not go on with a state that is no longer physical (docs/reliability.md, Guards). One kernel over the cells, one over the nodes, and one
// wait for the device; what was wrong is looked for only if something was.
#pragma once
#include <string>
#include <vector>

#include "kernels/cell_guard.hpp"
#include "physics/cells.hpp"
#include "physics/contact.hpp"
#include "physics/fluid.hpp"
#include "physics/problem.hpp"
#include "physics/units.hpp"

namespace corpuscle {

class Guards {
 public:
  /// @param cells none in a scene of fluid alone; as they start: a cell's first move is counted from there
  Guards(const Problem& problem, const LatticeParameters& lattice, const PeriodicBox& box, const Cells* cells);

  /// Changes nothing that the run computes. @param contact none where cells don't repel each other: then they may pierce each other too.
  /// @throws SimulationError when a limit is exceeded: step, strain, cell, place, limit, likely cause and the key to change.
  template <class Real>
  void check(const Fluid<Real>& fluid, const Cells* cells, const Contact* contact);

  std::size_t bytes() const;

 private:
  void look_at_cells(const Cells& cells, const Contact* contact, std::int64_t step);
  [[noreturn]] void stop_for_cell(const Cells& cells, std::int64_t step, CellFault fault, int cell, std::int64_t broken_nodes) const;
  [[noreturn]] void stop_for_fluid(const NodeState& node, std::int64_t step, std::int64_t broken_nodes) const;
  std::string opening(std::int64_t step, const std::string& guard) const;
  std::string place(const double (&position)[3]) const;
  std::string cell_name(const Cells& cells, int cell) const;

  GuardSpec spec_;
  PeriodicBox box_;
  double radius_ = 1, shear_rate_ = 0, contact_range_ = 1;
  double fastest_imposed_ = 0;  ///< velocity that the flow gives to cells
  std::int64_t last_step_ = 0;  ///< when the centres were seen
  GuardTables tables_;
  Array2<double> centres_;
  Kokkos::View<CellState*, MemSpace> states_;
  Kokkos::View<std::int64_t[2], Kokkos::LayoutRight, MemSpace> verdict_;  ///< gravest fault of cells (CellGuard), number of broken nodes
};

}  // namespace corpuscle
