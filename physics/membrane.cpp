#include "physics/membrane.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "kernels/strain_law.hpp"
#include "physics/membrane_driver.hpp"
#include "physics/mesh_device.hpp"

namespace corpuscle {
namespace {

template <class Real, class Law, bool needs_bending>
class MembraneOf final : public Membrane {
 public:
  MembraneOf(const Mesh& reference, const MembraneModuli& moduli, const Law& law, int first_vertex, int cell_count)
      : reference_(reference), ring_(one_ring(reference)) {
    const int vertices = int(reference.vertices.size()), faces = int(reference.faces.size());
    auto& t = block_.tables;
    t.degree = degrees_on_device(ring_, "membrane_degree");
    t.neighbour = ring_on_device(ring_, ring_.neighbour, "membrane_neighbour");
    t.opposite = ring_on_device(ring_, ring_.opposite, "membrane_opposite");
    t.reference = decltype(t.reference)("membrane_reference", vertices, ring_.max_degree);
    t.faces = faces_on_device(reference);

    block_.law = law;
    bending_stiffness_ = 2 * moduli.bending_constant * moduli.bending;
    block_.global.area_modulus = moduli.global_area;
    block_.global.volume_modulus = moduli.volume;
    block_.needs_global = moduli.global_area > 0 || moduli.volume > 0;
    block_.vertices = vertices;
    block_.faces = faces;
    block_.first_vertex = first_vertex;
    block_.cell_count = cell_count;
    // Shared memory of a device multiprocessor holds about 800 vertices twice; larger meshes go to global scratch.
    block_.scratch_level = !runs_on_host && block_.scratch_bytes() <= 40000 ? 0 : 1;
    set_reference_scale(1);
  }

  void set_reference_scale(double scale) override {
    auto& t = block_.tables;
    const auto reference = Kokkos::create_mirror_view(t.reference);
    const auto& x = reference_.vertices;
    using Tables = MembraneTables<Real>;
    for (int v = 0; v < ring_.vertex_count; ++v)
      for (int i = 0; i < ring_.degree[v]; ++i) {
        const int a = ring_.neighbour[v * ring_.max_degree + i];
        const int b = ring_.neighbour[v * ring_.max_degree + (i + 1) % ring_.degree[v]];
        const int before = ring_.neighbour[v * ring_.max_degree + (i + ring_.degree[v] - 1) % ring_.degree[v]];
        const int beyond = ring_.opposite[v * ring_.max_degree + i];
        const Vector3 e1 = scale * (x[a] - x[v]), e2 = scale * (x[b] - x[v]);
        Eigen::Matrix2d gram;
        gram << e1.dot(e1), e1.dot(e2), e1.dot(e2), e2.dot(e2);
        const Eigen::Matrix2d inverse = gram.inverse();
        const double spoke = edge_angle(x[v], x[a], x[b], x[before]), rim = edge_angle(x[a], x[b], x[v], x[beyond]);
        const double values[9] = {inverse(0, 0),      inverse(0, 1),   inverse(1, 1),   1 / gram.determinant(), 0.5 * std::sqrt(gram.determinant()),
                                  std::cos(spoke),    std::sin(spoke), std::cos(rim),   std::sin(rim)};
        static_assert(Tables::sin_rim == 8);
        for (int k = 0; k < 9; ++k) reference(v, i, k) = static_cast<Real>(values[k]);
      }
    Kokkos::deep_copy(t.reference, reference);
    block_.bending_stiffness = bending_stiffness_ * scale * scale;
    block_.global.area = mesh_area(reference_) * scale * scale;
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
    Kokkos::parallel_for(block.needs_global ? with_global : without_global, policy, block);
  }

  std::size_t bytes() const override {
    const auto& t = block_.tables;
    return (t.degree.span() + t.neighbour.span() + t.opposite.span() + t.faces.span()) * sizeof(int) + t.reference.span() * sizeof(Real);
  }

 private:
  Mesh reference_;
  OneRing ring_;
  // Profiles and tests see from the name what a scene pays for.
  static constexpr const char* without_global = needs_bending ? "membrane_forces, bending" : "membrane_forces";
  static constexpr const char* with_global = needs_bending ? "membrane_forces, bending, global" : "membrane_forces, global";
  double bending_stiffness_ = 0;
  MembraneBlock<Real, Law, needs_bending> block_{};
};

template <class Real, class Law>
std::unique_ptr<Membrane> pick_bending(const Mesh& reference, const MembraneModuli& moduli, const Law& law, int first_vertex, int cell_count) {
  if (moduli.bending > 0) return std::make_unique<MembraneOf<Real, Law, true>>(reference, moduli, law, first_vertex, cell_count);
  return std::make_unique<MembraneOf<Real, Law, false>>(reference, moduli, law, first_vertex, cell_count);
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
    if (precision == Precision::single_precision) return pick_bending<float>(reference, moduli, law, first_vertex, cell_count);
    return pick_bending<double>(reference, moduli, law, first_vertex, cell_count);
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
