// Kernel that computes the forces of one block of cells: one team a block. Host: a block is a SIMD pack of cells, which share topology and
// reference state, so that every operation works on several cells at once; devices: a block is one cell. Positions and forces of the block lie in
// scratch memory, where triangles and edges add to their vertices: every triangle and edge is computed once (a gather by vertices computes a triangle
// three times and an edge four times).
#pragma once
#include <type_traits>

#include "core/simd.hpp"
#include "kernels/membrane_force.hpp"
#include "physics/units.hpp"

namespace corpuscle {

template <class T>
struct AreaVolume {
  T area{0}, volume{0};
  KOKKOS_FORCEINLINE_FUNCTION AreaVolume& operator+=(const AreaVolume& other) {
    area = area + other.area;
    volume = volume + other.volume;
    return *this;
  }
};

namespace detail {
template <class Real, bool host>
struct PackOf {
  using type = Real;
  static constexpr int lanes = 1;
};
template <class Real>
struct PackOf<Real, true> {
  using type = HostPack<Real>;
  static constexpr int lanes = int(HostPack<Real>::size());
};
}  // namespace detail

/// Parameters of a type that change with the reference scale.
struct GlobalReference {
  double area = 0, volume = 0;                ///< of the undeformed cell
  double area_modulus = 0, volume_modulus = 0;
};

template <class Real, class Law, bool needs_bending, bool needs_area, bool needs_volume>
struct MembraneBlock {
  using Pack = typename detail::PackOf<Real, runs_on_host>::type;
  static constexpr int lanes = detail::PackOf<Real, runs_on_host>::lanes;
  using Policy = Kokkos::TeamPolicy<ExecSpace>;
  using Member = typename Policy::member_type;

  MembraneTables<Real> tables;
  Law law;
  double bending_stiffness;  ///< 2 p kappa_B
  double collapsed;          ///< (2 area)^2 below which a triangle's bending forces are bounded
  GlobalReference global;
  int vertices, faces, edges, first_vertex, cell_count, scratch_level;
  VertexVectors positions, forces;

  int blocks() const { return (cell_count + lanes - 1) / lanes; }
  std::size_t scratch_bytes() const { return std::size_t(vertices) * 6 * sizeof(Pack) + 64; }

  KOKKOS_FUNCTION void operator()(const Member& team) const {
    // Positions relative to the cell's first vertex: differences stay exact in single precision however far the cell has travelled.
    Real* const packed = static_cast<Real*>(team.team_scratch(scratch_level).get_shmem_aligned(std::size_t(vertices) * 6 * sizeof(Pack), 64));
    Real* const packed_forces = packed + std::size_t(vertices) * 3 * lanes;
    const int block = team.league_rank();
    std::size_t first_row[lanes];  // of each cell of the block
    for (int lane = 0; lane < lanes; ++lane) first_row[lane] = std::size_t(first_vertex + cell_of(block, lane) * vertices);
    const double* const x = positions.data();
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, vertices), [&](const int v) {
      for (int k = 0; k < 3; ++k) {
#pragma omp simd
        for (int lane = 0; lane < lanes; ++lane) {
          packed[(v * 3 + k) * lanes + lane] = static_cast<Real>(x[3 * (first_row[lane] + v) + k] - x[3 * first_row[lane] + k]);
          packed_forces[(v * 3 + k) * lanes + lane] = 0;
        }
      }
    });
    team.team_barrier();

    const auto position = [packed](const int v) { return Vec3<Pack>{load(packed, v, 0), load(packed, v, 1), load(packed, v, 2)}; };
    const auto add = [packed_forces](const int v, const Vec3<Pack>& force) {
      add_to(packed_forces, v, 0, force.x);
      add_to(packed_forces, v, 1, force.y);
      add_to(packed_forces, v, 2, force.z);
    };
    Tension<Pack> tension{Pack(Real(0)), Pack(Real(0))};
    if constexpr (needs_area || needs_volume) {
      AreaVolume<Pack> sum{Pack(Real(0)), Pack(Real(0))};
      const auto add_face = [&](const int f, AreaVolume<Pack>& total) {
        const Vec3<Pack> a = position(tables.faces(f, 0)), b = position(tables.faces(f, 1)), c = position(tables.faces(f, 2));
        const Vec3<Pack> normal = cross(b - a, c - a);
        if constexpr (needs_area) total.area = total.area + Pack(Real(0.5)) * Kokkos::sqrt(dot(normal, normal));
        if constexpr (needs_volume) total.volume = total.volume + Pack(Real(1.0 / 6)) * dot(a, normal);
      };
      if constexpr (runs_on_host)
        for (int f = 0; f < faces; ++f) add_face(f, sum);
      else
        Kokkos::parallel_reduce(Kokkos::TeamThreadRange(team, faces), add_face, sum);
      if constexpr (needs_area) tension.area = Pack(Real(global.area_modulus / global.area)) * (sum.area - Pack(Real(global.area)));
      if constexpr (needs_volume) tension.volume = Pack(Real(global.volume_modulus / global.volume)) * (sum.volume - Pack(Real(global.volume)));
    }
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, faces), [&](const int f) { triangle_forces<Real, Pack, Law, needs_area, needs_volume>(tables, law, tension, f, position, add); });
    if constexpr (needs_bending)
      Kokkos::parallel_for(Kokkos::TeamThreadRange(team, edges), [&](const int e) { edge_forces<Real, Pack>(tables, Pack(Real(bending_stiffness)), Pack(Real(collapsed)), e, position, add); });
    team.team_barrier();
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, vertices), [&](const int v) {
      const int used = cell_count - block * lanes < lanes ? cell_count - block * lanes : lanes;
      for (int lane = 0; lane < used; ++lane)
        for (int k = 0; k < 3; ++k) forces(first_row[lane] + v, k) = static_cast<double>(packed_forces[(v * 3 + k) * lanes + lane]);
    });
  }

 private:
  KOKKOS_FORCEINLINE_FUNCTION int cell_of(const int block, const int lane) const {
    const int cell = block * lanes + lane;
    return cell < cell_count ? cell : cell_count - 1;  // surplus lanes repeat the last cell
  }
  KOKKOS_FORCEINLINE_FUNCTION static Pack load(const Real* packed, const int v, const int k) {
    if constexpr (std::is_same_v<Pack, Real>) {
      return packed[v * 3 + k];
    } else {
      Pack pack;
      pack.copy_from(packed + (v * 3 + k) * lanes, Kokkos::Experimental::simd_flag_aligned);
      return pack;
    }
  }
  /// On devices the threads of a team add to the same vertices.
  KOKKOS_FORCEINLINE_FUNCTION static void add_to(Real* packed, const int v, const int k, const Pack& value) {
    if constexpr (std::is_same_v<Pack, Real>) {
      Kokkos::atomic_add(&packed[v * 3 + k], value);
    } else {
      (load(packed, v, k) + value).copy_to(packed + (v * 3 + k) * lanes, Kokkos::Experimental::simd_flag_aligned);
    }
  }
};

}  // namespace corpuscle

template <class T>
struct Kokkos::reduction_identity<corpuscle::AreaVolume<T>> {
  KOKKOS_FORCEINLINE_FUNCTION static corpuscle::AreaVolume<T> sum() { return {}; }
};
