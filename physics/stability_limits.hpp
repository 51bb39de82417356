// What is stable: the measured limits that scenes are checked against (docs/stability.md, `corpuscle stability`).
#pragma once
#include "physics/mesh.hpp"
#include "physics/units.hpp"

namespace corpuscle {

/// Mean over the surface of (2H)^2, H the mean curvature: sum over vertices |dA/dx_v|^2 N/A^2.
double squared_curvature(const Mesh& mesh);
/// Mean length of the edges.
double mean_edge(const Mesh& mesh);

/// Response of the fluid to the global terms in one step. A normal displacement d of the whole surface raises the pressure by kappa_V A d/V_0; the fluid answers like a
/// sound wave, with the velocity p/(2 rho c_s): the response is kappa_V A/(2 c_s V_0). The area term has the pressure kappa_A (2H)^2 d: kappa_A (2H)^2/(2 c_s).
double volume_response(const CellTypeLattice& cell, double modulus);
double area_response(const CellTypeLattice& cell, double modulus);
/// The moduli that have a given response.
double volume_modulus(const CellTypeLattice& cell, double response);
double area_modulus(const CellTypeLattice& cell, double response);

}  // namespace corpuscle
