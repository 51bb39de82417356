#include "physics/memory.hpp"

#include <algorithm>

#include "physics/contact.hpp"
#include "physics/coupling.hpp"
#include "physics/guards.hpp"
#include "physics/live_statistics.hpp"
#include "physics/packing.hpp"
#include "physics/suspension.hpp"
#include "physics/vertex_motion.hpp"

namespace corpuscle {
namespace {

constexpr std::size_t vector = 3 * sizeof(double);                         // of one vertex
constexpr std::size_t state_of_vertex = 3 * vector;                        // positions, velocities, forces
constexpr std::size_t largest_degree = 6;                                        // largest degree of a geodesic mesh; files may have a few vertices with more
constexpr std::size_t sample_of_cell = 26 * sizeof(double);                // CellSampler
constexpr std::size_t guard_of_cell = sizeof(CellState) + vector + 2 * sizeof(int);
constexpr std::size_t program_bytes = std::size_t(18) << 20;               // measured with a fluid of a few nodes

std::size_t membrane_tables(const CellTypeLattice& type, std::size_t real) {
  const std::size_t edges = type.moduli.bending > 0 ? type.faces * 3 / 2 : 0;
  return type.faces * (3 * sizeof(int) + 5 * real) + edges * (4 * sizeof(int) + 2 * real);
}

/// Triangles, edges, reference areas and neighbours of `Guards`.
std::size_t guard_tables(const CellTypeLattice& type) {
  return type.faces * (3 * sizeof(int) + sizeof(double)) + type.faces * 3 / 2 * 4 * sizeof(int) + (type.faces * 3 + type.vertices) * sizeof(int);
}

/// Lists, bins and keys of `Contact`, and the cell of each vertex. The number of neighbours depends on how the cells lie: a vertex where two surfaces touch (gap about half the reach)
/// sees the disk of the other one that the reach cuts out, and at the volume fraction phi about that fraction of the vertices touches.
std::size_t contact_bytes(const LatticeParameters& lattice, std::size_t vertices, double reach) {
  double area = 0;
  for (const auto& type : lattice.cells) area += double(type.count) * type.area;
  const double density = area > 0 ? double(vertices) / area : 0;
  const double disk = 3.14 * 0.75 * reach * reach;
  const double neighbours = std::min(1.0, lattice.phi_effective) * density * disk;
  const double bins = lattice.box_volume() / (reach * reach * reach);
  return vertices * (vector + 8 * sizeof(int)) + std::size_t(double(vertices) * 1.25 * neighbours * sizeof(int)) + std::size_t(bins * 2 * sizeof(int));
}

bool packs(const Problem& problem, const LatticeParameters& lattice) {
  std::int64_t total = 0;
  for (const auto& type : lattice.cells) total += type.count;
  return total > 1 && problem.run.packing.empty() &&
         std::any_of(problem.cells.begin(), problem.cells.end(), [](const CellSpec& spec) { return !spec.position; });
}

}  // namespace

std::size_t MemoryEstimate::peak() const { return program + std::max(packing, suspension() + statistics + std::max(settling, output)); }

MemoryEstimate predict_memory(const Problem& problem, const LatticeParameters& lattice) {
  MemoryEstimate m;
  const FluidParameters fluid = fluid_parameters(problem, lattice);
  m.fluid = problem.accuracy.precision == Precision::single_precision ? Fluid<float>::predicted_bytes(fluid) : Fluid<double>::predicted_bytes(fluid);
  m.program = runs_on_host ? program_bytes : 0;
  const bool with_fluid = lattice.snapshot_every > 0 && problem.output.fluid;
  const auto nodes = std::size_t(lattice.box_volume());
  // The velocities of the fluid, [nodes][3] floats: from the kernel, and as a host array.
  if (with_fluid) m.output += nodes * 3 * sizeof(float) * (runs_on_host ? 2 : 1);
  // A checkpoint takes the populations one at a time, from the kernel and as a host array.
  std::size_t checkpoint = nodes * (problem.accuracy.precision == Precision::single_precision ? 4 : 8) * (runs_on_host ? 2 : 1);
  if (problem.cells.empty()) {
    m.output = std::max(m.output, checkpoint);
    return m;
  }

  const std::size_t real = problem.accuracy.membrane_precision == Precision::single_precision ? 4 : 8;
  std::size_t vertices = 0, cells = 0, packing_tables = 0;
  for (const auto& type : lattice.cells) {
    vertices += std::size_t(type.count * type.vertices);
    cells += std::size_t(type.count);
    m.tables += membrane_tables(type, real) + type.faces * 3 * sizeof(int);  // the sampler's triangles too
    m.tables += guard_tables(type);
    packing_tables += membrane_tables(type, sizeof(float));
    if (problem.accuracy.vertex_update == VertexUpdate::chebyshev) m.tables += type.vertices * (1 + largest_degree) * sizeof(int);
  }
  m.vertices = vertices * (state_of_vertex + VertexMotion::bytes_per_vertex(problem.accuracy.vertex_update, lattice.coupling_every)) + cells * (sample_of_cell + guard_of_cell);
  const Grid grid{lattice.nodes[0], lattice.nodes[1], lattice.nodes[2], fluid.halo};
  m.vertices += Coupling<double>::predicted_bytes(grid, problem.accuracy.delta_kernel, vertices);
  const double skin = ContactParameters{}.skin;
  if (problem.contact.enabled) m.contact = contact_bytes(lattice, vertices, lattice.contact_range + skin);

  const std::size_t host_copy = runs_on_host ? 1 : 0;
  if (packs(problem, lattice)) {
    m.packing = vertices * state_of_vertex + packing_tables + contact_bytes(lattice, vertices, packing_reach(lattice)) + host_copy * vertices * vector;
    m.settling = 5 * vertices * vector;
  }
  // A snapshot: positions and velocities, and as floats positions, velocities and deformation for the file.
  if (lattice.snapshot_every > 0) m.output += host_copy * vertices * (2 * vector + 7 * sizeof(float));
  // A checkpoint: positions, velocities, and those of the two steps before.
  checkpoint += host_copy * vertices * (VertexMotion::keeps_velocities(problem.accuracy.vertex_update, lattice.coupling_every) ? 4 : 2) * vector;
  if (problem.output.statistics && runs_on_host) {
    m.statistics = LiveStatistics::predicted_bytes(cells);
    checkpoint += 2 * m.statistics;  // as plain numbers, those of the correlators on the way
  }
  m.output = std::max(m.output, checkpoint);
  return m;
}

}  // namespace corpuscle
