#include "physics/stretching.hpp"

#include <algorithm>

#include "physics/contact_patches.hpp"

namespace corpuscle {
namespace {

struct AddStretchingForces {
  int first_vertex, vertices, pulled;
  Array1<int> vertex;
  VertexVectors share, forces;
  KOKKOS_FUNCTION void operator()(const int i) const {
    const int cell = i / pulled, entry = i - cell * pulled;
    const int v = first_vertex + cell * vertices + vertex(entry);
    for (int k = 0; k < 3; ++k) forces(v, k) += share(entry, k);
  }
};

}  // namespace

bool Stretching::needed(const Problem& problem) {
  return std::any_of(problem.cells.begin(), problem.cells.end(), [](const CellSpec& spec) { return spec.stretch.force.value_or(0) > 0; });
}

Stretching::Stretching(const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types) {
  for (std::size_t t = 0; t < types.size(); ++t) {
    const double force = lattice.cells[t].stretching_force;
    if (!(force > 0)) continue;
    const CellSpec& spec = problem.cells[t];
    const ContactPatches patches = contact_patches(types[t].reference, direction_in_reference(spec), spec.stretch.patch_diameter * types[t].radius);
    const int pulled = int(patches.ahead.size() + patches.behind.size());
    Pulled p{types[t].first_vertex, types[t].vertices(), types[t].count, Array1<int>("stretched_vertices", pulled), VertexVectors("stretching_shares", pulled)};
    const auto vertex = Kokkos::create_mirror_view(p.vertex);
    const auto share = Kokkos::create_mirror_view(p.force);
    const Vector3 lab = Vector3(spec.stretch.direction[0], spec.stretch.direction[1], spec.stretch.direction[2]).normalized();
    int entry = 0;
    const auto pull = [&](const std::vector<int>& patch, double total) {
      for (const int v : patch) {
        vertex(entry) = v;
        for (int k = 0; k < 3; ++k) share(entry, k) = total / double(patch.size()) * lab[k];
        ++entry;
      }
    };
    pull(patches.ahead, force);
    pull(patches.behind, -force);
    Kokkos::deep_copy(p.vertex, vertex);
    Kokkos::deep_copy(p.force, share);
    types_.push_back(p);
  }
}

void Stretching::add_forces(const VertexVectors& forces) const {
  for (const Pulled& p : types_) {
    const int pulled = int(p.vertex.extent(0));
    Kokkos::parallel_for("stretching_forces", Kokkos::RangePolicy<ExecSpace>(0, p.cells * pulled),
                         AddStretchingForces{p.first_vertex, p.vertices, pulled, p.vertex, p.force, forces});
  }
}

std::size_t Stretching::bytes() const {
  std::size_t total = 0;
  for (const Pulled& p : types_) total += p.vertex.span() * sizeof(int) + p.force.span() * sizeof(double);
  return total;
}

}  // namespace corpuscle
