#include "physics/packing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "physics/contact.hpp"
#include "physics/membrane.hpp"
#include "physics/placement.hpp"

namespace corpuscle {
namespace {

// Overdamped relaxation in lattice units. The moduli have nothing to do with the flow's: soft enough for a mobility of 0.2 (explicit steps are stable below about 1/4 of the
// inverse stiffness), with a stiff volume, so that crowded cells give way in shape and not in volume.
constexpr double mobility = 0.2;
constexpr double shear = 0.3, dilation = 0.6, bending = 1.0 / 405, repulsion = 0.1;
struct Penalty {
  double area, volume;  // moduli of the global constraints
};
constexpr Penalty growing{0.5, 2.0}, settling{2.0, 8.0};  // crowded cells may give way while they grow; then volumes and areas return
constexpr double largest_move = 0.08;  // of a vertex in a round: a fraction of the contact range, so that surfaces cannot pass through each other
constexpr double rigid_gain = 12;      // extra mobility of a cell's rigid motion: pushes from contacts move whole cells at once
constexpr double sphere_fraction = 0.22;  // of the bounding spheres at the start: random placement succeeds quickly
constexpr double growth_per_round = 0.06; // outward motion of the rim in a round
constexpr double first_gap = 0.5, least_gap = 0.25;  // of the range: cells grow only while no two come closer; where that stalls the gap shrinks step by step
constexpr int patience = 150;             // rounds without growth before it does
constexpr double reach = 1.5;             // range of the repulsion / contact range of the scene: keeps a vertex from slipping between the corners of a triangle
constexpr double packing_skin = 0.5;      // of the contact lists
constexpr int settling_rounds = 60;

/// Range of the repulsion, lattice units.
double packing_range(const LatticeParameters& lattice) { return reach * (lattice.contact_range > 0 ? lattice.contact_range : 1.0); }

/// Mean of the vertices base ... base + vertices - 1.
struct VertexMean {
  double c[3] = {};
  KOKKOS_FORCEINLINE_FUNCTION VertexMean(const VertexVectors& x, const int base, const int vertices) {
    for (int v = base; v < base + vertices; ++v)
      for (int k = 0; k < 3; ++k) c[k] += x(v, k) / vertices;
  }
  KOKKOS_FORCEINLINE_FUNCTION double operator[](const int k) const { return c[k]; }
};

/// Moves the vertices of one cell: x += mobility F, plus the rigid motion that the total force and torque ask for.
struct Relax {
  int first_vertex, vertices;
  double step_limit;
  VertexVectors x, force;
  KOKKOS_FUNCTION void operator()(const int cell) const {
    const int base = first_vertex + cell * vertices;
    const VertexMean c(x, base, vertices), f(force, base, vertices);
    double torque[3] = {}, inertia = 0;
    for (int v = base; v < base + vertices; ++v) {
      const double r[3] = {x(v, 0) - c[0], x(v, 1) - c[1], x(v, 2) - c[2]};
      for (int k = 0; k < 3; ++k) {
        torque[k] += r[(k + 1) % 3] * force(v, (k + 2) % 3) - r[(k + 2) % 3] * force(v, (k + 1) % 3);
        inertia += r[k] * r[k] * 2.0 / 3.0;
      }
    }
    for (int v = base; v < base + vertices; ++v) {
      const double r[3] = {x(v, 0) - c[0], x(v, 1) - c[1], x(v, 2) - c[2]};
      double move[3], squared = 0;
      for (int k = 0; k < 3; ++k) {
        const double turn = (torque[(k + 1) % 3] * r[(k + 2) % 3] - torque[(k + 2) % 3] * r[(k + 1) % 3]) / inertia;
        move[k] = mobility * (force(v, k) + rigid_gain * (f[k] + turn));
        squared += move[k] * move[k];
      }
      const double shrink = squared > step_limit * step_limit ? step_limit / Kokkos::sqrt(squared) : 1.0;
      for (int k = 0; k < 3; ++k) x(v, k) += shrink * move[k];
    }
  }
};

/// Scales every cell about its centre.
struct Grow {
  int first_vertex, vertices;
  double factor;
  VertexVectors x;
  KOKKOS_FUNCTION void operator()(const int cell) const {
    const int base = first_vertex + cell * vertices;
    const VertexMean c(x, base, vertices);
    for (int v = base; v < base + vertices; ++v)
      for (int k = 0; k < 3; ++k) x(v, k) = c[k] + factor * (x(v, k) - c[k]);
  }
};

[[noreturn]] void does_not_fit(const LatticeParameters& lattice, const std::string& why) {
  throw InputError("The cells could not be packed: " + why + " at volume fraction " + std::to_string(lattice.phi_geometric) + " (effective " +
                   std::to_string(lattice.phi_effective) + "); lower cells.volume_fraction or count, enlarge box.size, or try another run.seed.");
}

/// All cells where the scene says, or the only cell in the centre of the box.
std::vector<double> place_explicitly(const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types) {
  std::vector<double> positions;
  for (std::size_t t = 0; t < types.size(); ++t) {
    Vector3 centre(0.5 * lattice.nodes[0], 0.5 * lattice.nodes[1], 0.5 * lattice.nodes[2]);
    if (const auto& p = problem.cells[t].position) centre = lattice.radius * Vector3((*p)[0], (*p)[1], (*p)[2]);
    UnitQuaternion turn{1, 0, 0, 0};
    if (const auto& axis = problem.cells[t].axis) turn = rotation_to_axis(*axis);
    const auto placed = place_mesh(types[t].reference, centre, turn);
    positions.insert(positions.end(), placed.begin(), placed.end());
  }
  return positions;
}

class Packer {
 public:
  Packer(const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types)
      : problem_(problem), lattice_(lattice), types_(types), scale_(start_scale()), cells_(types, start_positions()),
        contact_(periodic_box(), {repulsion, range(), packing_skin}, cells_.cell_of_vertex()) {
    make_membranes(growing);
    for (const auto& type : types) largest_radius_ = std::max(largest_radius_, bounding_radius(type.reference));
  }

  std::vector<double> run(const PackingProgress& progress) {
    double gap = contact_.smallest_gap(cells_.positions());
    double wanted = first_gap;
    int rounds = 0, waited = 0;
    while (scale_ < 1 || gap < 0.9 * wanted * range()) {
      ++rounds;
      if (++waited > patience) {
        wanted *= 0.9;
        waited = 0;
        if (wanted < least_gap) does_not_fit(lattice_, scale_ < 1 ? "growth stalled" : "cells still touch after relaxation");
      }
      if (scale_ < 1 && gap > wanted * range()) {
        grow();
        waited = 0;
      }
      relax();
      gap = contact_.smallest_gap(cells_.positions());
      if (progress && rounds % 10 == 0 && !progress(scale_, gap, rounds)) throw InputError("The packing was stopped.");
    }
    settle();
    if (progress) progress(scale_, gap, rounds);
    return cells_.positions_host();
  }

 private:
  void make_membranes(const Penalty& penalty) {
    membranes_.clear();
    for (const auto& type : types_) {
      const double bending_modulus = bending * shear * type.radius * type.radius;
      const MembraneModuli soft{StrainLawKind::skalak, shear, dilation, bending_modulus, type.moduli.bending_constant, penalty.area, penalty.volume};
      membranes_.push_back(make_membrane(type.reference, soft, Precision::single_precision, type.first_vertex, type.count));
      membranes_.back()->set_reference_scale(scale_);
    }
  }
  double range() const { return packing_range(lattice_); }

  double start_scale() const {
    double spheres = 0;
    for (const auto& type : types_) spheres += type.count * 4.0 / 3.0 * std::numbers::pi * std::pow(bounding_radius(type.reference) + 0.5 * range(), 3);
    return std::min(1.0, std::cbrt(sphere_fraction * lattice_.box_volume() / spheres));
  }

  /// Random places; smaller cells where the spheres do not fit at once (narrow boxes, margins that do not shrink with the cells).
  std::vector<double> start_positions() {
    for (int attempt = 0;; ++attempt) {
      try {
        return start_positions_at_scale();
      } catch (const InputError&) {
        if (attempt == 5) throw;
        scale_ *= 0.85;
      }
    }
  }

  std::vector<double> start_positions_at_scale() const {
    PlacementRequest request;
    for (int k = 0; k < 3; ++k) request.box[k] = lattice_.nodes[k];
    request.walls_z = problem_.box.walls;
    request.seed = problem_.run.seed;
    request.wall_gap = 0.5 * range();
    for (const auto& type : types_)
      for (int c = 0; c < type.count; ++c) request.radii.push_back(scale_ * bounding_radius(type.reference) + 0.5 * range());
    const Placement placement = place_spheres(request);
    std::vector<double> positions;
    int cell = 0;
    for (const auto& type : types_)
      for (int c = 0; c < type.count; ++c, ++cell) {
        const auto placed = place_mesh(type.reference, placement.centres[cell], placement.orientations[cell], scale_);
        positions.insert(positions.end(), placed.begin(), placed.end());
      }
    return positions;
  }

  void grow() {
    const double next = std::min(1.0, scale_ + growth_per_round / largest_radius_);
    for (std::size_t t = 0; t < types_.size(); ++t) {
      Kokkos::parallel_for("packing_grow", Kokkos::RangePolicy<ExecSpace>(0, types_[t].count),
                           Grow{types_[t].first_vertex, types_[t].vertices(), next / scale_, cells_.positions()});
      membranes_[t]->set_reference_scale(next);
    }
    scale_ = next;
  }

  void relax() {
    for (const auto& membrane : membranes_) membrane->compute_forces(cells_.positions(), cells_.forces());
    contact_.add_forces(cells_.positions(), cells_.forces());
    for (const auto& type : types_)
      Kokkos::parallel_for("packing_relax", Kokkos::RangePolicy<ExecSpace>(0, type.count),
                           Relax{type.first_vertex, type.vertices(), largest_move * range(), cells_.positions(), cells_.forces()});
  }

  /// More rounds at full size with the scene's own contact range: the pressure that held surfaces apart during growth goes, volumes and areas return.
  void settle() {
    make_membranes(settling);
    contact_ = Contact(periodic_box(), {repulsion, range() / reach, packing_skin}, cells_.cell_of_vertex());
    for (int i = 0; i < settling_rounds; ++i) relax();
  }
  PeriodicBox periodic_box() const { return PeriodicBox(Grid{lattice_.nodes[0], lattice_.nodes[1], lattice_.nodes[2], 1}, problem_.box.walls); }

  const Problem& problem_;
  const LatticeParameters& lattice_;
  const std::vector<CellType>& types_;
  double scale_;
  double largest_radius_ = 0;
  Cells cells_;
  Contact contact_;
  std::vector<std::unique_ptr<Membrane>> membranes_;
};

}  // namespace

std::vector<double> place_cells(const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types, const PackingProgress& progress) {
  if (types.empty()) return {};
  std::size_t placed = 0;
  for (const auto& cell : problem.cells) placed += cell.position ? 1 : 0;
  const bool explicitly = !packs_cells(problem, types);
  if (!explicitly && placed > 0)
    throw InputError("cells.position is given for some cell types only; give it for all of them, or for none so that all are packed at random.");
  auto positions = explicitly ? place_explicitly(problem, lattice, types) : Packer(problem, lattice, types).run(progress);
  const auto report = overlap_of(problem, lattice, types, positions);
  if (!report.is_clean()) {
    const std::string what = report.vertices_outside_walls > 0 ? "a cell reaches beyond a wall"
                                                               : "cell " + std::to_string(report.first_cell) + " overlaps cell " + std::to_string(report.second_cell);
    if (explicitly) throw InputError("cells.position puts cells on top of each other or of a wall (" + what + "); move them apart.");
    does_not_fit(lattice, what);
  }
  return positions;
}

double packing_reach(const LatticeParameters& lattice) { return packing_range(lattice) + packing_skin; }

OverlapReport overlap_of(const Problem& problem, const LatticeParameters& lattice, const std::vector<CellType>& types, const std::vector<double>& positions) {
  CellGeometry geometry;
  for (int k = 0; k < 3; ++k) geometry.box[k] = lattice.nodes[k];
  geometry.walls_z = problem.box.walls;
  for (const auto& type : types)
    for (int c = 0; c < type.count; ++c)
      geometry.cells.push_back({&positions[3 * (std::size_t(type.first_vertex) + std::size_t(c) * type.vertices())], type.vertices(), &type.reference.faces});
  return check_overlap(geometry);
}

bool packs_cells(const Problem& problem, const std::vector<CellType>& types) {
  int total = 0;
  bool everywhere = true;
  for (const auto& type : types) total += type.count;
  for (const auto& cell : problem.cells) everywhere = everywhere && cell.position.has_value();
  return total > 1 && !everywhere;
}

}  // namespace corpuscle
