// One lattice unit in SI units, for scenes that say how large and how stiff their cells are ([si] in docs/scene.md).
#pragma once
#include <optional>
#include <utility>
#include <vector>

#include "physics/problem.hpp"

namespace corpuscle {

/// Lattice value times this = value in SI units; empty where [si] does not fix it. Other units follow: stress force/length^2, velocity length/time, energy
/// force*length. Density is no scale: at small Reynolds numbers inertia has no effect, and the lattice has more of it than the real fluid.
struct SiUnits {
  std::optional<double> length;  ///< m
  std::optional<double> force;   ///< N
  std::optional<double> time;    ///< s: one time step
};

/// What outputs call the units, and their values where [si] fixes them: unit_length_m, unit_force_N, unit_time_s.
std::vector<std::pair<const char*, double>> named_units(const SiUnits& units);

/// From what is known in both worlds: the radius, kappa_S = 3 G_s, and the viscosity.
/// @param radius, kappa, viscosity of the lattice; kappa of the scene (types with relative_stiffness 1)
SiUnits si_units(const SiSpec& si, double radius, double kappa, double viscosity);

}  // namespace corpuscle
