#include "physics/cells.hpp"

#include <stdexcept>
#include <string>

#include "core/huge_pages.hpp"
#include "physics/hydrodynamic_size.hpp"

namespace corpuscle {

std::vector<CellType> make_cell_types(const Problem& problem, const LatticeParameters& lattice) {
  std::vector<CellType> types;
  int cell = 0, vertex = 0;
  for (std::size_t t = 0; t < problem.cells.size(); ++t) {
    const auto& from = lattice.cells[t];
    CellType type;
    type.name = from.name;
    type.radius = from.radius;
    type.moduli = from.moduli;
    type.reference = make_cell_mesh(problem.cells[t], problem.accuracy, from.radius, from.subdivision);
    type.count = int(from.count);
    type.first_cell = cell;
    type.first_vertex = vertex;
    cell += type.count;
    vertex += type.count * type.vertices();
    types.push_back(std::move(type));
  }
  return types;
}

Cells::Cells(std::vector<CellType> types, const std::vector<double>& positions) : types_(std::move(types)) {
  for (const auto& type : types_) {
    cell_count_ += type.count;
    vertex_count_ += type.count * type.vertices();
  }
  if (positions.size() != 3 * std::size_t(vertex_count_))
    throw std::invalid_argument("Cells: " + std::to_string(positions.size()) + " coordinates for " + std::to_string(vertex_count_) + " vertices");
  positions_ = to_device(positions, "positions");
  velocities_ = zeros_on_huge_pages<VertexVectors>("velocities", vertex_count_);
  forces_ = zeros_on_huge_pages<VertexVectors>("forces", vertex_count_);
}

Array1<int> Cells::cell_of_vertex() const {
  const Array1<int> numbers("contact_cell_of_vertex", vertex_count_);
  const auto host = Kokkos::create_mirror_view(numbers);
  for (const auto& type : types_)
    for (int i = 0; i < type.count * type.vertices(); ++i) host(type.first_vertex + i) = type.first_cell + i / type.vertices();
  Kokkos::deep_copy(numbers, host);
  return numbers;
}

}  // namespace corpuscle
