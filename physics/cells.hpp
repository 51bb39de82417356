// All cells of a suspension: types (topology, reference shape, moduli) and the state of every vertex.
#pragma once
#include <string>
#include <vector>

#include "core/types.hpp"
#include "core/vertex_vectors.hpp"
#include "physics/mesh.hpp"
#include "physics/units.hpp"

namespace corpuscle {

/// Cells of one type share mesh, reference shape and moduli. Their vertices lie one cell after the other.
struct CellType {
  std::string name;
  Mesh reference;          ///< stress-free shape, lattice units
  MembraneModuli moduli;
  double radius = 0;       ///< large radius, lattice units
  int count = 0;
  int first_cell = 0;
  int first_vertex = 0;

  int vertices() const { return int(reference.vertices.size()); }
  int faces() const { return int(reference.faces.size()); }
};

/// The types of a scene with their meshes; `lattice` must come from the same problem.
std::vector<CellType> make_cell_types(const Problem& problem, const LatticeParameters& lattice);

/// State of all vertices, [V][3] each, ordered by type, cell, vertex. Lattice units, positions unwrapped.
class Cells {
 public:
  /// @throws std::invalid_argument when the positions are not those of all vertices
  Cells(std::vector<CellType> types, const std::vector<double>& positions);

  const std::vector<CellType>& types() const { return types_; }
  int cell_count() const { return cell_count_; }
  int vertex_count() const { return vertex_count_; }
  VertexVectors positions() const { return positions_; }
  VertexVectors velocities() const { return velocities_; }
  VertexVectors forces() const { return forces_; }
  /// Number of the cell of each vertex, [V]: a new array at each call. Contacts keep one; nothing else needs it.
  Array1<int> cell_of_vertex() const;

  std::vector<double> positions_host() const { return to_host(positions_); }
  std::vector<double> velocities_host() const { return to_host(velocities_); }
  /// Takes positions and velocities of all vertices from the host.
  void restore(const std::vector<double>& positions, const std::vector<double>& velocities) const {
    Kokkos::deep_copy(positions_, to_device(positions));
    Kokkos::deep_copy(velocities_, to_device(velocities));
  }
  std::size_t bytes() const { return 3 * positions_.span() * sizeof(double); }

 private:
  std::vector<CellType> types_;
  int cell_count_ = 0, vertex_count_ = 0;
  VertexVectors positions_, velocities_, forces_;
};

}  // namespace corpuscle
