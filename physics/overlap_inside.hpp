// Is a point inside a closed triangulation?
#pragma once
#include <array>
#include <vector>

#include "physics/overlap.hpp"

namespace corpuscle {

/// Answers for many points and one cell. A ray upwards counts the faces it crosses, signed by their orientation; the faces are sorted into
/// columns of the x-y plane, so a query looks at a few faces only.
class InsideTest {
 public:
  /// Takes another cell; the buffers are kept.
  void reset(const CellView& cell);
  const Vector3& lower() const { return lower_; }  ///< bounding box of the cell
  const Vector3& upper() const { return upper_; }
  /// True strictly inside; a point on the surface is outside.
  bool contains(const Vector3& point) const;

 private:
  std::array<int, 2> column(double x, double y) const;
  Vector3 vertex(int v) const { return {cell_.positions[3 * v], cell_.positions[3 * v + 1], cell_.positions[3 * v + 2]}; }

  CellView cell_;
  Vector3 lower_, upper_;
  std::array<int, 2> columns_{};
  std::array<double, 2> per_length_{};
  std::vector<int> begin_, faces_;  // compressed rows: faces over each column
};

/// Winding number of the surface around a point from the solid angles of its faces (Van Oosterom & Strackee 1983): slow, never ambiguous.
double winding_number(const CellView& cell, const Vector3& point);

}  // namespace corpuscle
