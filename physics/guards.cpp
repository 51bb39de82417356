#include "physics/guards.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "core/to_host.hpp"

namespace corpuscle {
namespace {

constexpr double slow = 0.1;  // speed of a fluid far from instability, lattice units

template <class T>
Array1<T> on_device(const std::vector<T>& host, const std::string& label) {
  const Array1<T> view(label, host.size());
  Kokkos::deep_copy(view, Kokkos::View<const T*, Kokkos::LayoutRight, Kokkos::HostSpace>(host.data(), host.size()));
  return view;
}

template <int columns>
Kokkos::View<int* [columns], Kokkos::LayoutRight, MemSpace> on_device(const std::vector<std::array<int, columns>>& host, const std::string& label) {
  const Kokkos::View<int* [columns], Kokkos::LayoutRight, MemSpace> view(label, host.size());
  const auto mirror = Kokkos::create_mirror_view(view);
  for (std::size_t row = 0; row < host.size(); ++row)
    for (int k = 0; k < columns; ++k) mirror(row, k) = host[row][k];
  Kokkos::deep_copy(view, mirror);
  return view;
}

GuardTables make_tables(const std::vector<CellType>& types) {
  std::vector<int> type_of_cell, first_vertex, type_vertex{0}, type_face{0}, type_edge{0}, ring_begin{0}, ring;
  std::vector<std::array<int, 3>> faces;
  std::vector<std::array<int, 4>> edges;
  std::vector<double> face_area, reference_volume, reference_area;
  int vertices = 0;
  for (std::size_t t = 0; t < types.size(); ++t) {
    const CellType& type = types[t];
    for (int c = 0; c < type.count; ++c) {
      type_of_cell.push_back(int(t));
      first_vertex.push_back(vertices);
      vertices += type.vertices();
    }
    const auto& x = type.reference.vertices;
    for (const auto& f : type.reference.faces) {
      faces.push_back(f);
      face_area.push_back(0.5 * (x[f[1]] - x[f[0]]).cross(x[f[2]] - x[f[0]]).norm());
    }
    for (const auto& e : mesh_edges(type.reference)) edges.push_back({e.p, e.q, e.left, e.right});
    const OneRing rings = one_ring(type.reference);
    for (int v = 0; v < rings.vertex_count; ++v) {
      for (int i = 0; i < rings.degree[v]; ++i) ring.push_back(rings.neighbour[v * rings.max_degree + i]);
      ring_begin.push_back(int(ring.size()));
    }
    type_vertex.push_back(type_vertex.back() + type.vertices());
    type_face.push_back(int(faces.size()));
    type_edge.push_back(int(edges.size()));
    reference_volume.push_back(mesh_volume(type.reference));
    reference_area.push_back(mesh_area(type.reference));
  }
  first_vertex.push_back(vertices);
  GuardTables tables;
  tables.type_of_cell = on_device(type_of_cell, "guard_type_of_cell");
  tables.first_vertex = on_device(first_vertex, "guard_first_vertex");
  tables.type_vertex = on_device(type_vertex, "guard_type_vertex");
  tables.type_face = on_device(type_face, "guard_type_face");
  tables.type_edge = on_device(type_edge, "guard_type_edge");
  tables.faces = on_device<3>(faces, "guard_faces");
  tables.edges = on_device<4>(edges, "guard_edges");
  tables.face_area = on_device(face_area, "guard_face_area");
  tables.reference_volume = on_device(reference_volume, "guard_reference_volume");
  tables.reference_area = on_device(reference_area, "guard_reference_area");
  tables.ring_begin = on_device(ring_begin, "guard_ring_begin");
  tables.ring = on_device(ring, "guard_ring");
  return tables;
}

/// What usually is behind it, and what to do.
const char* advice(CellFault fault) {
  switch (fault) {
    case CellFault::not_a_number:
    case CellFault::speed:
      return "Likely the membrane or the contacts are too stiff for the time step: lower accuracy.shear_modulus, membrane.area_dilation or contact.strength, and leave "
             "accuracy.allow_unstable = false.";
    case CellFault::outside:
      return "Likely the flow presses cells through the wall: raise contact.strength or contact.range, keep contact.enabled = true, or lower flow.capillary_number.";
    case CellFault::jump:
      return "No flow moves a cell so far: likely memory, a file or the device is faulty. Go on from an earlier state; if it happens at the same step again, report it.";
    case CellFault::volume:
      return "Likely the volume force is too weak for this flow, or the state is about to break: raise membrane.volume, or lower accuracy.mach_max.";
    case CellFault::area:
      return "Likely the membrane yields to the flow: lower flow.capillary_number or raise membrane.area_dilation or membrane.global_area; if such cells are meant, raise the limit.";
    case CellFault::collapse:
      return "Likely the mesh is too coarse for this deformation: raise accuracy.radius or accuracy.subdivision, membrane.area_dilation or membrane.bending.";
    case CellFault::fold:
      return "Likely the membrane buckles more sharply than the mesh can show: raise membrane.bending, accuracy.radius or accuracy.subdivision.";
    case CellFault::penetration:
      return "Likely the contact force is too weak for this flow: raise contact.strength or contact.range, or lower accuracy.mach_max.";
    case CellFault::none: break;
  }
  return "";
}

}  // namespace

Guards::Guards(const Problem& problem, const LatticeParameters& lattice, const PeriodicBox& box, const Cells* cells)
    : spec_(problem.guards), box_(box), radius_(lattice.radius), shear_rate_(lattice.shear_rate), contact_range_(lattice.contact_range), verdict_("guard_verdict") {
  // As for the contact lists: at rest relaxing membranes move by less than a tenth of the speed of sound.
  fastest_imposed_ = (lattice.mach_number > 0 ? 2 * lattice.mach_number : 0.1) * speed_of_sound;
  if (cells == nullptr) return;
  tables_ = make_tables(cells->types());
  centres_ = Array2<double>("guard_centres", cells->cell_count(), 3);
  states_ = Kokkos::View<CellState*, MemSpace>("guard_states", cells->cell_count());
  const auto x = cells->positions_host();
  const auto centres = Kokkos::create_mirror_view(centres_);
  for (const auto& type : cells->types())
    for (int i = 0; i < type.count * type.vertices(); ++i)
      for (int k = 0; k < 3; ++k) centres(type.first_cell + i / type.vertices(), k) += x[3 * std::size_t(type.first_vertex + i) + k] / type.vertices();
  Kokkos::deep_copy(centres_, centres);
}

void Guards::look_at_cells(const Cells& cells, const Contact* contact, std::int64_t step) {
  CellLimits limits{};
  limits.speed = spec_.speed;
  limits.volume_drift = spec_.volume_drift;
  limits.area_drift = spec_.area_drift;
  limits.collapse = spec_.collapse;
  limits.damaged = spec_.damaged;
  limits.fold_cosine = spec_.fold < 180 ? std::cos(spec_.fold * std::numbers::pi / 180) : -2.0;
  limits.penetration = spec_.penetration * contact_range_;
  limits.contact_range = contact_range_;
  double smallest = radius_;
  for (const auto& type : cells.types()) smallest = std::min(smallest, type.radius);
  limits.move = fastest_imposed_ * double(std::abs(step - last_step_)) + smallest;
  last_step_ = step;
  CellGuard guard{tables_, limits, box_, cells.positions(), cells.velocities(), cells.forces(), {}, {}, {}, centres_, states_};
  if (contact != nullptr && contact->rebuilds() > 0) {
    guard.cell_of_vertex = contact->cell_of_vertex();
    guard.near_begin = contact->neighbours().begin;
    guard.near = contact->neighbours().list;
  }
  const DeviceCount gravest = Kokkos::subview(verdict_, 0);
  const CellGuard::Policy policy = runs_on_host ? CellGuard::Policy(cells.cell_count(), 1) : CellGuard::Policy(cells.cell_count(), Kokkos::AUTO);
  Kokkos::parallel_reduce("guard_cells", policy, guard, Kokkos::Min<std::int64_t, MemSpace>(gravest));
}

template <class Real>
void Guards::check(const Fluid<Real>& fluid, const Cells* cells, const Contact* contact) {
  Kokkos::deep_copy(ExecSpace(), verdict_, no_fault);
  fluid.count_broken(spec_.density, spec_.speed, Kokkos::subview(verdict_, 1));
  if (cells != nullptr) look_at_cells(*cells, contact, fluid.step());
  const auto verdict = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, verdict_);
  const std::int64_t broken_nodes = verdict(1);
  if (verdict(0) != no_fault) stop_for_cell(*cells, fluid.step(), CellFault(verdict(0) >> 32), int(verdict(0) & 0xffffffff), broken_nodes);
  if (broken_nodes > 0) stop_for_fluid(fluid.first_broken(spec_.density, spec_.speed).value_or(NodeState{}), fluid.step(), broken_nodes);
}

std::string Guards::opening(std::int64_t step, const std::string& guard) const {
  const std::string strain = shear_rate_ > 0 ? fmt::format(" (strain {:.4g})", shear_rate_ * double(step)) : "";
  return fmt::format("The guard on {} stopped the run before step {}{}: ", guard, step, strain);
}

std::string Guards::place(const double (&position)[3]) const {
  double p[3];
  for (int k = 0; k < 3; ++k) p[k] = (k == 2 && box_.walls ? position[k] : position[k] - box_.length[k] * std::floor(position[k] / box_.length[k])) / radius_;
  return fmt::format("near ({:.2f}, {:.2f}, {:.2f}) cell radii", p[0], p[1], p[2]);
}

std::string Guards::cell_name(const Cells& cells, int cell) const {
  for (const auto& type : cells.types())
    if (cell < type.first_cell + type.count) return fmt::format("cell {} ({})", cell, type.name);
  return fmt::format("cell {}", cell);
}

void Guards::stop_for_cell(const Cells& cells, std::int64_t step, CellFault fault, int cell, std::int64_t broken_nodes) const {
  const auto states = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, states_);
  const auto centres = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, centres_);
  const auto x = cells.positions_host();
  const CellState& s = states(cell);
  const auto types = cells.types();
  const CellType& type = *std::find_if(types.begin(), types.end(), [&](const CellType& t) { return cell < t.first_cell + t.count; });
  const int base = type.first_vertex + (cell - type.first_cell) * type.vertices();
  double centre[3];
  for (int k = 0; k < 3; ++k) centre[k] = centres(cell, k);
  const auto at_vertex = [&](int v) {
    const std::size_t i = 3 * std::size_t(v);
    return place({x[i], x[i + 1], x[i + 2]});
  };
  const auto first_row = [&](const Array1<int>& rows) { return to_host(rows)[std::size_t(&type - types.data())]; };
  const std::string name = cell_name(cells, cell);
  std::string what;
  switch (fault) {
    case CellFault::not_a_number:
      what = opening(step, "numbers") + fmt::format("{}, last seen {}, has a vertex ({}) whose position, velocity or force is not a number.", name, place(centre), s.broken_vertex - base);
      break;
    case CellFault::outside:
      what = opening(step, "walls") + fmt::format("a vertex of {} {} is {:.3g} lattice units beyond a wall.", name, at_vertex(s.outermost), s.beyond);
      break;
    case CellFault::speed:
      what = opening(step, "speed") + fmt::format("a vertex of {} {} moves at {:.3g} lattice units a step, the limit is {:g} (guards.speed).", name, at_vertex(s.fastest),
                                                  std::sqrt(s.speed_squared), spec_.speed);
      break;
    case CellFault::jump:
      what = opening(step, "identity") + fmt::format("{} is found {}, {:.3g} cell radii from where it was at the last check.", name, place(centre), s.moved / radius_);
      break;
    case CellFault::volume:
      what = opening(step, "volume") + fmt::format("{} {} has {:.4g} times the volume of its reference shape, the limit is a change by {:g} (guards.volume_drift).", name,
                                                   place(centre), s.volume / mesh_volume(type.reference), spec_.volume_drift);
      break;
    case CellFault::area:
      what = opening(step, "area") + fmt::format("{} {} has {:.4g} times the area of its reference shape, the limit is a change by {:g} (guards.area_drift).", name, place(centre),
                                                 s.area / mesh_area(type.reference), spec_.area_drift);
      break;
    case CellFault::collapse: {
      const auto& face = type.reference.faces[std::size_t(s.smallest_face - first_row(tables_.type_face))];
      what = opening(step, "triangles") + fmt::format("a triangle of {} {} has shrunk to {:.2g} of its area, the limit is {:g} (guards.collapse); {} of {} are beyond it, "
                                                      "{:g} of them may be (guards.damaged).", name, at_vertex(base + face[0]), s.smallest, spec_.collapse, s.collapsed,
                                                      type.reference.faces.size(), spec_.damaged);
      break;
    }
    case CellFault::fold: {
      const auto edge = mesh_edges(type.reference)[std::size_t(s.sharpest_edge - first_row(tables_.type_edge))];
      what = opening(step, "folds") + fmt::format("two triangles of {} {} are folded onto each other, {:.1f} degrees between their normals, the limit is {:g} "
                                                  "(guards.fold); {} of {} edges are beyond it, {:g} of them may be (guards.damaged).", name, at_vertex(base + edge.p),
                                                  std::acos(std::max(-1.0, s.sharpest)) * 180 / std::numbers::pi, spec_.fold, s.folded,
                                                  mesh_edges(type.reference).size(), spec_.damaged);
      break;
    }
    case CellFault::penetration:
      what = opening(step, "contact") + fmt::format("a vertex of {} {} lies {:.3g} lattice units inside {}, the limit is {:g} (guards.penetration = {:g} of contact.range).", name,
                                                    at_vertex(s.deepest), s.depth, cell_name(cells, s.pierced_cell), spec_.penetration * contact_range_, spec_.penetration);
      break;
    case CellFault::none: break;
  }
  what += std::string(" ") + advice(fault);
  int others = -1;
  for (std::size_t c = 0; c < states.extent(0); ++c) others += states(c).fault != CellFault::none;
  if (others > 0) what += fmt::format(" {} other cell{} beyond a limit too.", others, others == 1 ? " is" : "s are");
  if (broken_nodes > 0) what += fmt::format(" The fluid is beyond a limit at {} node{}.", broken_nodes, broken_nodes == 1 ? "" : "s");
  throw SimulationError(what);
}

void Guards::stop_for_fluid(const NodeState& node, std::int64_t step, std::int64_t broken_nodes) const {
  const bool density = !(std::abs(node.density - 1) <= spec_.density);
  const auto shown = [](double value) { return std::isfinite(value) ? fmt::format("{:.3g}", value) : std::string("not a number"); };
  const double position[3] = {node.node[0] + 0.5, node.node[1] + 0.5, node.node[2] + 0.5};
  // A slow fluid isn't unstable: pressures between crowded cells compress it. At one Reynolds number stresses are (tau - 1/2)^2 in lattice units, and so is the density (docs/accuracy.md).
  const bool compressed = density && std::isfinite(node.density) && node.speed < slow && states_.extent(0) > 0;
  const std::string cause = compressed ? "the stresses of the cells compress the fluid: lower accuracy.relaxation_time (the density varies as (tau - 1/2)^2) or flow.reynolds_number_max, or give the cells more room"
                            : density  ? "the flow is too fast or its viscosity too low for a stable fluid: lower accuracy.mach_max or flow.reynolds_number_max, or move accuracy.relaxation_time away from 0.5"
                                       : "the flow is too fast for the lattice: lower accuracy.mach_max or flow.reynolds_number_max, or move accuracy.relaxation_time away from 0.5";
  throw SimulationError(opening(step, "the fluid") +
                        fmt::format("{} nodes are beyond a limit, the first one {}, where the density is {} and the speed in lattice units {}; the limits are 1 +- {:g} "
                                    "(guards.density) and {:g} (guards.speed). Likely {}.",
                                    broken_nodes, place(position), shown(node.density), shown(node.speed), spec_.density, spec_.speed, cause));
}

std::size_t Guards::bytes() const { return tables_.bytes() + centres_.span() * sizeof(double) + states_.span() * sizeof(CellState); }

template void Guards::check(const Fluid<float>&, const Cells*, const Contact*);
template void Guards::check(const Fluid<double>&, const Cells*, const Contact*);

}  // namespace corpuscle
