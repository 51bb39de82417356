// What the resolution does to the viscosity of a suspension, as the studies of docs/accuracy.md measured it.
#pragma once
#include <limits>
#include <span>
#include <string>

#include "physics/problem.hpp"
#include "physics/units.hpp"

namespace corpuscle {

/// How a scene counts its cells decides what their shells do: see docs/accuracy.md.
enum class CountedBy { mesh, viscosity_shell, drag_shell, hydrodynamic };
const char* name_of(CountedBy counted);
/// Of the first cell type.
CountedBy counted_by(const Problem& problem);
/// The volume fraction that the scene asks for in its way of counting, with the whole number of cells that came of it.
double counted_fraction(const Problem& problem, const LatticeParameters& lattice);

/// Of TRT in the studies.
constexpr double studied_relaxation_time = 2;

/// A setting that was measured: relative deviation of the viscosity from its limit of infinite resolution.
struct MeasuredDeviation {
  double phi = 0;   ///< that the scene asks for
  CountedBy counted{};
  int delta_kernel = 0;
  double radius = 0;
  double deviation = 0, uncertainty = 0;
};
/// Made from docs/accuracy/*.json by report/resolution_table.py; a test compares the two.
std::span<const MeasuredDeviation> measured_deviations();

struct ResolutionError {
  double value = std::numeric_limits<double>::quiet_NaN(), uncertainty = value;  ///< relative: 0.05 means that the viscosity comes out 5 % too large. NaN where it isn't known
  std::string reason;                  ///< why it isn't known, or what it was interpolated between
  bool known() const { return uncertainty > 0; }
};

/// Interpolated between what was measured: linear in 1/radius and in phi, which is 0 where nothing disturbs the fluid. Only for red cells of one type in shear between walls, phi and radius in the
/// measured range (a radius beyond the finest gets its deviation times the ratio of the radii); everything else isn't known, and the reason says so.
ResolutionError viscosity_resolution_error(const Problem& problem, const LatticeParameters& lattice);

}  // namespace corpuscle
