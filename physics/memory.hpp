// How much memory a scene will need, before anything is allocated.
#pragma once
#include <cstddef>

#include "physics/problem.hpp"
#include "physics/units.hpp"

namespace corpuscle {

/// Bytes by what needs them.
struct MemoryEstimate {
  std::size_t fluid = 0;     ///< populations; with cells force and velocity
  std::size_t vertices = 0;  ///< state of all vertices, order of spreading, samples of the cells
  std::size_t tables = 0;    ///< topology and reference state of the cell types
  std::size_t contact = 0;   ///< neighbour lists
  std::size_t statistics = 0;  ///< of a running simulation, on the host
  // One after the other:
  std::size_t packing = 0;   ///< before the rest is there
  std::size_t settling = 0;  ///< beside the suspension, before the first step
  std::size_t output = 0;    ///< beside the suspension, when a snapshot is written
  std::size_t program = 0;   ///< code and libraries

  /// What `make_suspension` allocates: `Suspension::bytes`.
  std::size_t suspension() const { return fluid + vertices + tables + contact; }
  /// The most at any time. On the host of the whole process; on devices of their memory.
  std::size_t peak() const;
};

MemoryEstimate predict_memory(const Problem& problem, const LatticeParameters& lattice);

}  // namespace corpuscle
