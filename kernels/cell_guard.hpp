// What guards look at in every cell: is it finite, where it may be, and is its surface still one (docs/reliability.md, Guards). One team a cell.
#pragma once
#include <cstdint>

#include "kernels/contact.hpp"
#include "kernels/signed_distance.hpp"
#include "kernels/stencil.hpp"

namespace corpuscle {

/// In the order from cause to consequence: a run is stopped for the first one found. What blows up is too fast before it leaves the box.
enum class CellFault : int { not_a_number, speed, outside, jump, volume, area, collapse, fold, penetration, none };

/// Lattice units.
struct CellLimits {
  double speed, volume_drift, area_drift, collapse;
  double fold_cosine;   ///< of the angle between normals
  double damaged;       ///< share of a cell's triangles that may be smaller than `collapse`, and of its edges that may be sharper than the fold
  double penetration;   ///< depth
  double contact_range; ///< vertices further from all others than this are not asked for their depth
  double move;          ///< of a cell's centre since it was looked at before
};

/// Largest departures of one cell, and the vertex (of all), triangle or edge (of its type) where they are.
struct CellState {
  double centre[3] = {};  ///< mean of the vertices
  double volume = 0, area = 0;
  double speed_squared = 0;
  double beyond = -1e300;    ///< a wall
  double smallest = 1e300;   ///< area of a triangle / its reference
  double sharpest = 1;       ///< cosine between the normals at an edge
  double depth = -1e300;     ///< of a vertex inside another cell
  double moved = 0;
  int broken_vertex = INT32_MAX, fastest = 0, outermost = 0, smallest_face = 0, sharpest_edge = 0, deepest = 0, pierced_cell = 0;
  int collapsed = 0, folded = 0;  ///< triangles and edges beyond their limits
  CellFault fault = CellFault::none;

  KOKKOS_FUNCTION void join(const CellState& other) {
    for (int k = 0; k < 3; ++k) centre[k] += other.centre[k];
    volume += other.volume;
    area += other.area;
    collapsed += other.collapsed;
    folded += other.folded;
    broken_vertex = other.broken_vertex < broken_vertex ? other.broken_vertex : broken_vertex;
    if (other.speed_squared > speed_squared) speed_squared = other.speed_squared, fastest = other.fastest;
    if (other.beyond > beyond) beyond = other.beyond, outermost = other.outermost;
    if (other.smallest < smallest) smallest = other.smallest, smallest_face = other.smallest_face;
    if (other.sharpest < sharpest) sharpest = other.sharpest, sharpest_edge = other.sharpest_edge;
    if (other.depth > depth) depth = other.depth, deepest = other.deepest, pierced_cell = other.pierced_cell;
  }
};

/// Kokkos reducer over CellState.
struct JoinStates {
  using reducer = JoinStates;
  using value_type = CellState;
  using result_view_type = Kokkos::View<CellState, Kokkos::AnonymousSpace, Kokkos::MemoryUnmanaged>;
  CellState* result;
  KOKKOS_FUNCTION explicit JoinStates(CellState& state) : result(&state) {}
  KOKKOS_FUNCTION void join(CellState& to, const CellState& from) const { to.join(from); }
  KOKKOS_FUNCTION void init(CellState& state) const { state = CellState(); }
  KOKKOS_FUNCTION CellState& reference() const { return *result; }
  KOKKOS_FUNCTION result_view_type view() const { return result_view_type(result); }
  KOKKOS_FUNCTION bool references_scalar() const { return true; }
};

/// Topology of all types one after the other, and where each cell finds its own. Numbers of vertices are those within a cell.
struct GuardTables {
  Array1<int> type_of_cell, first_vertex;                          ///< [cells], [cells + 1]
  Array1<int> type_vertex, type_face, type_edge;                   ///< [types + 1] first row of each type in the tables below
  Kokkos::View<int* [3], Kokkos::LayoutRight, MemSpace> faces;
  Kokkos::View<int* [4], Kokkos::LayoutRight, MemSpace> edges;     ///< p, q, left, right
  Array1<double> face_area;                                        ///< reference
  Array1<double> reference_volume, reference_area;                 ///< [types]
  Array1<int> ring_begin, ring;                                    ///< neighbours of each vertex, counter-clockwise seen from outside
  std::size_t bytes() const {
    return (type_of_cell.span() + first_vertex.span() + type_vertex.span() + type_face.span() + type_edge.span() + faces.span() + edges.span() + ring_begin.span() + ring.span()) *
               sizeof(int) + (face_area.span() + reference_volume.span() + reference_area.span()) * sizeof(double);
  }
};

/// Stands for "no cell has a fault".
inline constexpr std::int64_t no_fault = INT64_MAX;

/// Fills `states` [cells] and reduces to the gravest fault and the first cell that has it: fault * 2^32 + cell.
struct CellGuard {
  using Policy = Kokkos::TeamPolicy<ExecSpace>;
  using Member = Policy::member_type;

  GuardTables tables;
  CellLimits limits;
  PeriodicBox box;
  VertexVectors x, u, f;
  Array1<int> cell_of_vertex;                     ///< with contact
  Array1<int> near_begin, near;                   ///< vertices of other cells near each vertex; empty without contact
  Array2<double> centres;                         ///< [cells][3] of the last look, replaced by the present ones
  Kokkos::View<CellState*, MemSpace> states;

  KOKKOS_FORCEINLINE_FUNCTION Vec3<double> between(const int from, const int to) const { return {x(to, 0) - x(from, 0), x(to, 1) - x(from, 1), x(to, 2) - x(from, 2)}; }

  KOKKOS_FUNCTION void look_at_vertex(CellState& s, const int v) const {
    double sum = 0, squared = 0;
    for (int k = 0; k < 3; ++k) {
      s.centre[k] += x(v, k);
      squared += u(v, k) * u(v, k);
      sum += Kokkos::fabs(x(v, k)) + Kokkos::fabs(f(v, k));
    }
    if (!(sum + squared < 1e100) && v < s.broken_vertex) s.broken_vertex = v;
    if (squared > s.speed_squared) s.speed_squared = squared, s.fastest = v;
    if (box.walls) {
      const double above = x(v, 2) - box.length[2], beyond = above > -x(v, 2) ? above : -x(v, 2);
      if (beyond > s.beyond) s.beyond = beyond, s.outermost = v;
    }
    if (near_begin.extent(0) > 0) look_for_depth(s, v);
  }
  /// Below the surface near the vertex of another cell that is closest to v. That may mislead: a thin cell may turn its far side to v, and a sharp edge triangles
  /// whose corners are far from v. So before a cell counts as pierced, all of its triangles are asked.
  KOKKOS_FUNCTION void look_for_depth(CellState& s, const int v) const {
    int nearest = -1;
    double least = limits.contact_range * limits.contact_range;
    for (int i = near_begin(v); i < near_begin(v + 1); ++i) {
      const double squared = PairVector(box, x, v, near(i)).squared();
      if (squared < least) least = squared, nearest = near(i);
    }
    if (nearest < 0) return;
    SignedDistance distance;
    look_around(distance, v, nearest);
    double depth = distance.depth();
    if (depth > limits.penetration) depth = depth_in_cell(v, nearest);
    if (depth > s.depth) s.depth = depth, s.deepest = v, s.pierced_cell = cell_of_vertex(nearest);
  }
  /// Of vertex v in the image of a cell whose vertex w is close to it.
  KOKKOS_FUNCTION double depth_in_cell(const int v, const int w) const {
    const PairVector pair(box, x, v, w);
    const Vec3<double> to_w{-pair.d[0], -pair.d[1], -pair.d[2]};
    const int cell = cell_of_vertex(w), base = tables.first_vertex(cell), type = tables.type_of_cell(cell);
    const auto from_v = [&](const int face, const int corner) { return to_w + between(w, base + tables.faces(face, corner)); };
    DepthInSurface surface;
    for (int face = tables.type_face(type); face < tables.type_face(type + 1); ++face) surface.look_at(from_v(face, 0), from_v(face, 1), from_v(face, 2));
    return surface.depth();
  }
  /// The triangles around vertex w, seen from v.
  KOKKOS_FUNCTION void look_around(SignedDistance& distance, const int v, const int w) const {
    const PairVector pair(box, x, v, w);
    const int cell = cell_of_vertex(w), base = tables.first_vertex(cell), row = tables.type_vertex(tables.type_of_cell(cell)) + w - base;
    const int begin = tables.ring_begin(row), end = tables.ring_begin(row + 1);
    Vec3<double> a = between(w, base + tables.ring(end - 1));
    for (int i = begin; i < end; ++i) {
      const Vec3<double> b = between(w, base + tables.ring(i));
      distance.look_at({pair.d[0], pair.d[1], pair.d[2]}, a, b);
      a = b;
    }
  }
  KOKKOS_FUNCTION void look_at_face(CellState& s, const int base, const int face) const {
    const Vec3<double> a = between(base, base + tables.faces(face, 0)), b = between(base, base + tables.faces(face, 1)), c = between(base, base + tables.faces(face, 2));
    const Vec3<double> normal = cross(b - a, c - a);
    const double area = 0.5 * Kokkos::sqrt(dot(normal, normal)), ratio = area / tables.face_area(face);
    s.volume += dot(a, normal) / 6;
    s.area += area;
    s.collapsed += !(ratio >= limits.collapse);
    if (ratio < s.smallest) s.smallest = ratio, s.smallest_face = face;
  }
  KOKKOS_FUNCTION void look_at_edge(CellState& s, const int base, const int edge) const {
    const int p = base + tables.edges(edge, 0);
    const Vec3<double> along = between(p, base + tables.edges(edge, 1));
    const Vec3<double> left = cross(along, between(p, base + tables.edges(edge, 2))), right = cross(between(p, base + tables.edges(edge, 3)), along);
    const double product = dot(left, right);
    if (product >= 0) return;
    const double cosine = product / Kokkos::sqrt(dot(left, left) * dot(right, right));
    s.folded += cosine < limits.fold_cosine;
    if (cosine < s.sharpest) s.sharpest = cosine, s.sharpest_edge = edge;
  }
  KOKKOS_FUNCTION CellFault judge(const CellState& s, const int type) const {
    if (s.broken_vertex != INT32_MAX) return CellFault::not_a_number;
    if (s.speed_squared > limits.speed * limits.speed) return CellFault::speed;
    if (s.beyond > 0) return CellFault::outside;
    if (s.moved > limits.move) return CellFault::jump;
    if (!(Kokkos::fabs(s.volume / tables.reference_volume(type) - 1) <= limits.volume_drift)) return CellFault::volume;
    if (!(Kokkos::fabs(s.area / tables.reference_area(type) - 1) <= limits.area_drift)) return CellFault::area;
    // A sharp edge of a soft membrane squeezes single triangles to nothing, and lets go of them again; many at a time are a surface that is no more.
    if (s.collapsed > limits.damaged * (tables.type_face(type + 1) - tables.type_face(type))) return CellFault::collapse;
    if (s.folded > limits.damaged * (tables.type_edge(type + 1) - tables.type_edge(type))) return CellFault::fold;
    if (s.depth > limits.penetration) return CellFault::penetration;
    return CellFault::none;
  }

  KOKKOS_FUNCTION void operator()(const Member& team, std::int64_t& gravest) const {
    const int cell = team.league_rank(), type = tables.type_of_cell(cell), base = tables.first_vertex(cell);
    const int vertices = tables.first_vertex(cell + 1) - base;
    CellState s, part;
    Kokkos::parallel_reduce(Kokkos::TeamThreadRange(team, base, base + vertices), [&](const int v, CellState& state) { look_at_vertex(state, v); }, JoinStates(s));
    Kokkos::parallel_reduce(Kokkos::TeamThreadRange(team, tables.type_face(type), tables.type_face(type + 1)),
                            [&](const int face, CellState& state) { look_at_face(state, base, face); }, JoinStates(part));
    s.join(part);
    Kokkos::parallel_reduce(Kokkos::TeamThreadRange(team, tables.type_edge(type), tables.type_edge(type + 1)),
                            [&](const int edge, CellState& state) { look_at_edge(state, base, edge); }, JoinStates(part));
    s.join(part);
    Kokkos::single(Kokkos::PerTeam(team), [&]() {
      double squared = 0;
      for (int k = 0; k < 3; ++k) {
        s.centre[k] /= vertices;
        squared += (s.centre[k] - centres(cell, k)) * (s.centre[k] - centres(cell, k));
        if (s.broken_vertex == INT32_MAX) centres(cell, k) = s.centre[k];
      }
      s.moved = Kokkos::sqrt(squared);
      s.fault = judge(s, type);
      states(cell) = s;
      const std::int64_t found = s.fault == CellFault::none ? no_fault : std::int64_t(s.fault) * (std::int64_t(1) << 32) + cell;
      if (found < gravest) gravest = found;
    });
  }
};

}  // namespace corpuscle
