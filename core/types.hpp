// Spaces and array types that the whole code shares.
#pragma once
#include <Kokkos_Core.hpp>

namespace corpuscle {

using ExecSpace = Kokkos::DefaultExecutionSpace;
using MemSpace = ExecSpace::memory_space;

/// True where kernels run on the host: rows are vectorised by the compiler, spreading is coloured instead of atomic.
inline constexpr bool runs_on_host = Kokkos::SpaceAccessibility<Kokkos::HostSpace, MemSpace>::accessible &&
                                     std::is_same_v<MemSpace, Kokkos::HostSpace>;

/// Populations of the lattice: [19][stride], one contiguous run of nodes for each direction.
template <class Storage>
using Populations = Kokkos::View<Storage**, Kokkos::LayoutRight, MemSpace>;

/// Force density or velocity on the nodes: [padded nodes][4], the fourth component is padding for 16-byte access (13x on spreading against separate components and atomics).
template <class Real>
using VectorField = Kokkos::View<Real* [4], Kokkos::LayoutRight, MemSpace>;

/// Per-vertex vectors of all cells: [vertices][3]. Always double: at low capillary number a vertex moves 1e-6 lattice units a step.
using VertexVectors = Kokkos::View<double* [3], Kokkos::LayoutRight, MemSpace>;

template <class T>
using Array1 = Kokkos::View<T*, Kokkos::LayoutRight, MemSpace>;
template <class T>
using Array2 = Kokkos::View<T**, Kokkos::LayoutRight, MemSpace>;

}  // namespace corpuscle
