// What a surface must satisfy to be the membrane of a cell.
#pragma once
#include <string>

#include "physics/mesh.hpp"

namespace corpuscle {

/// Checks that `mesh` is one closed, manifold, consistently oriented surface of genus 0 without degenerate triangles or vertices of more than
/// `largest_degree` neighbours. A surface that is inside out as a whole is turned; everything else is the user's to repair.
/// @throws InputError one sentence that starts with `source` and names the first offending face, edge or vertex (counted from 0, as in OFF files).
void require_cell_surface(Mesh& mesh, const std::string& source);

inline constexpr int largest_degree = 12;

}  // namespace corpuscle
