// Elastic forces of all cells of one type (docs/theory/model.md, Membrane): E = E_S + E_B + E_A + E_V, F = -dE/dx.
#pragma once
#include <memory>

#include "core/types.hpp"
#include "physics/mesh.hpp"
#include "physics/units.hpp"

namespace corpuscle {

/// Operator for `cell_count` cells of the same type whose vertices lie one cell after the other from `first_vertex` on.
class Membrane {
 public:
  virtual ~Membrane() = default;

  /// forces = -dE/dx (overwrites the rows of this type). positions, forces [V][3], lattice units.
  virtual void compute_forces(const VertexVectors& positions, const VertexVectors& forces) const = 0;

  /// Takes the reference shape scaled by this factor as undeformed (growth during packing). The bending modulus scales with its square, so that
  /// bending stays as strong against shear as at full size.
  virtual void set_reference_scale(double scale) = 0;

  virtual std::size_t bytes() const = 0;
};

/// Factory: picks law, arithmetic and bending from the moduli. Without bending its kernel code is not there; without global terms the
/// pass over the faces is skipped.
/// @param reference stress-free shape in lattice units
std::unique_ptr<Membrane> make_membrane(const Mesh& reference, const MembraneModuli& moduli, Precision precision, int first_vertex, int cell_count);

/// Elastic energies of one cell on the host, straight from the definitions: the check of the forces, and an output.
struct MembraneEnergy {
  double strain = 0, bending = 0, area = 0, volume = 0;
  double total() const { return strain + bending + area + volume; }
};
MembraneEnergy membrane_energy(const Mesh& reference, const MembraneModuli& moduli, const std::vector<Vector3>& vertices);

}  // namespace corpuscle
