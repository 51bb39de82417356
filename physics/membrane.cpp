#include "physics/membrane.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "kernels/strain_law.hpp"
#include "physics/membrane_driver.hpp"
#include "physics/mesh_device.hpp"

namespace corpuscle {
namespace {

/// Triangles with less than this share of the mean reference area have bounded bending forces (kernels/membrane_force.hpp).
constexpr double squeezed_triangle = 0.2;

template <class Real, class Law, bool needs_bending, bool needs_area, bool needs_volume>
class MembraneOf final : public Membrane {
 public:
  MembraneOf(const Mesh& reference, const MembraneModuli& moduli, const Law& law, int first_vertex, int cell_count) : reference_(reference) {
    auto& t = block_.tables;
    t.faces = faces_on_device(reference);
    t.face_reference = decltype(t.face_reference)("membrane_face_reference", reference.faces.size());
    if constexpr (needs_bending) {
      edges_ = mesh_edges(reference);
      t.edges = decltype(t.edges)("membrane_edges", edges_.size());
      t.edge_reference = decltype(t.edge_reference)("membrane_edge_reference", edges_.size());
      const auto edges = Kokkos::create_mirror_view(t.edges);
      for (std::size_t e = 0; e < edges_.size(); ++e) {
        const int corners[4] = {edges_[e].p, edges_[e].q, edges_[e].left, edges_[e].right};
        for (int k = 0; k < 4; ++k) edges(e, k) = corners[k];
      }
      Kokkos::deep_copy(t.edges, edges);
    }

    block_.law = law;
    bending_stiffness_ = 2 * moduli.bending_constant * moduli.bending;
    block_.global.area_modulus = moduli.global_area;
    block_.global.volume_modulus = moduli.volume;
    block_.vertices = int(reference.vertices.size());
    block_.faces = int(reference.faces.size());
    block_.edges = int(edges_.size());
    block_.first_vertex = first_vertex;
    block_.cell_count = cell_count;
    // Shared memory of a device multiprocessor holds about 800 vertices twice; larger meshes go to global scratch.
    block_.scratch_level = !runs_on_host && block_.scratch_bytes() <= 40000 ? 0 : 1;
    if constexpr (needs_bending) set_reference_angles();
    set_reference_scale(1);
  }

  void set_reference_scale(double scale) override {
    auto& t = block_.tables;
    const auto faces = Kokkos::create_mirror_view(t.face_reference);
    const auto& x = reference_.vertices;
    for (std::size_t f = 0; f < reference_.faces.size(); ++f) {
      const auto& corner = reference_.faces[f];
      const Vector3 e1 = scale * (x[corner[1]] - x[corner[0]]), e2 = scale * (x[corner[2]] - x[corner[0]]);
      Eigen::Matrix2d gram;
      gram << e1.dot(e1), e1.dot(e2), e1.dot(e2), e2.dot(e2);
      const Eigen::Matrix2d inverse = gram.inverse();
      const double values[] = {inverse(0, 0), inverse(0, 1), inverse(1, 1), 1 / gram.determinant(), 0.5 * std::sqrt(gram.determinant())};
      static_assert(std::size(values) == MembraneTables<Real>::face_values);
      for (int k = 0; k < MembraneTables<Real>::face_values; ++k) faces(f, k) = static_cast<Real>(values[k]);
    }
    Kokkos::deep_copy(t.face_reference, faces);
    block_.bending_stiffness = bending_stiffness_ * scale * scale;
    block_.global.area = mesh_area(reference_) * scale * scale;
    block_.collapsed = std::pow(squeezed_triangle * 2 * block_.global.area / block_.faces, 2);
    block_.global.volume = mesh_volume(reference_) * scale * scale * scale;
  }

  void compute_forces(const VertexVectors& positions, const VertexVectors& forces) const override {
    if (block_.cell_count == 0) return;
    auto block = block_;
    block.positions = positions;
    block.forces = forces;
    using Policy = typename decltype(block)::Policy;
    const auto scratch = Kokkos::PerTeam(int(block.scratch_bytes()));
    Policy policy = runs_on_host ? Policy(block.blocks(), 1) : Policy(block.blocks(), Kokkos::AUTO);
    policy.set_scratch_size(block.scratch_level, scratch);
    if (runs_on_host) policy.set_chunk_size(1);
    static const std::string name = label();
    Kokkos::parallel_for(name, policy, block);
  }

  std::size_t bytes() const override {
    const auto& t = block_.tables;
    return (t.faces.span() + t.edges.span()) * sizeof(int) + (t.face_reference.span() + t.edge_reference.span()) * sizeof(Real);
  }

 private:
  /// The same at any scale.
  void set_reference_angles() {
    const auto& x = reference_.vertices;
    const auto angles = Kokkos::create_mirror_view(block_.tables.edge_reference);
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      const double angle = edge_angle(x[edges_[e].p], x[edges_[e].q], x[edges_[e].left], x[edges_[e].right]);
      angles(e, 0) = static_cast<Real>(std::cos(angle));
      angles(e, 1) = static_cast<Real>(std::sin(angle));
    }
    Kokkos::deep_copy(block_.tables.edge_reference, angles);
  }

  Mesh reference_;
  std::vector<MeshEdge> edges_;
  /// Profiles and tests see from the name what a scene pays for.
  static std::string label() { return std::string("membrane_forces") + (needs_bending ? ", bending" : "") + (needs_area ? ", area" : "") + (needs_volume ? ", volume" : ""); }
  double bending_stiffness_ = 0;
  MembraneBlock<Real, Law, needs_bending, needs_area, needs_volume> block_{};
};

/// A membrane computes only what its moduli ask for.
template <class Real, class Law>
std::unique_ptr<Membrane> with_needed_terms(const Mesh& reference, const MembraneModuli& moduli, const Law& law, int first_vertex, int cell_count) {
  std::unique_ptr<Membrane> membrane;
  const auto when = [](bool needed, const auto& f) { needed ? f(std::true_type{}) : f(std::false_type{}); };
  when(moduli.bending > 0, [&](auto bending) {
    when(moduli.global_area > 0, [&](auto area) {
      when(moduli.volume > 0, [&](auto volume) {
        membrane = std::make_unique<MembraneOf<Real, Law, bending.value, area.value, volume.value>>(reference, moduli, law, first_vertex, cell_count);
      });
    });
  });
  return membrane;
}

/// Calls f with the strain law of the moduli. A new law is a line here.
template <class F>
auto with_strain_law(const MembraneModuli& moduli, const F& f) {
  if (moduli.law == StrainLawKind::neo_hookean) return f(NeoHookean{moduli.shear});
  return f(Skalak{moduli.shear, moduli.area_dilation});
}

}  // namespace

std::unique_ptr<Membrane> make_membrane(const Mesh& reference, const MembraneModuli& moduli, Precision precision, int first_vertex, int cell_count) {
  return with_strain_law(moduli, [&](const auto& law) {
    if (precision == Precision::single_precision) return with_needed_terms<float>(reference, moduli, law, first_vertex, cell_count);
    return with_needed_terms<double>(reference, moduli, law, first_vertex, cell_count);
  });
}

MembraneEnergy membrane_energy(const Mesh& reference, const MembraneModuli& moduli, const std::vector<Vector3>& vertices) {
  MembraneEnergy energy;
  const auto& x0 = reference.vertices;
  Mesh deformed{vertices, reference.faces};
  for (const auto& f : reference.faces) {
    const auto edges = [&](const std::vector<Vector3>& x) {
      Eigen::Matrix<double, 3, 2> m;
      m << x[f[1]] - x[f[0]], x[f[2]] - x[f[0]];
      return m;
    };
    const Eigen::Matrix2d g0 = edges(x0).transpose() * edges(x0), g = edges(vertices).transpose() * edges(vertices);
    const double i1 = (g0.inverse() * g).trace() - 2, i2 = g.determinant() / g0.determinant() - 1;
    energy.strain += 0.5 * std::sqrt(g0.determinant()) * with_strain_law(moduli, [&](const auto& law) { return law.energy_density(i1, i2); });
  }
  for (const auto& e : mesh_edges(reference)) {
    const auto angle = [&](const std::vector<Vector3>& x) { return edge_angle(x[e.p], x[e.q], x[e.left], x[e.right]); };
    const double change = angle(vertices) - angle(x0);
    energy.bending += moduli.bending_constant * moduli.bending * change * change;
  }
  const double a0 = mesh_area(reference), v0 = mesh_volume(reference);
  energy.area = 0.5 * moduli.global_area * std::pow(mesh_area(deformed) - a0, 2) / a0;
  energy.volume = 0.5 * moduli.volume * std::pow(mesh_volume(deformed) - v0, 2) / v0;
  return energy;
}

}  // namespace corpuscle
