#include "physics/overlap_inside.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernels/signed_distance.hpp"

namespace corpuscle {
namespace {

/// On which side of the line a -> b, seen from above, the point p is: +1 left, -1 right. A point on the line is moved by (e, e^2), e -> 0, so
/// a ray through an edge or a vertex crosses exactly one of the faces there. Evaluated from the lower index to the higher one: both faces at an
/// edge get the same answer whatever the rounding. 0 when a and b coincide from above: a face over such an edge has no area there.
int side(const Vector3& a, const Vector3& b, const Vector3& p) {
  const double ax = a.x() - p.x(), ay = a.y() - p.y(), bx = b.x() - p.x(), by = b.y() - p.y();
  const double left = ax * by, right = ay * bx;
  if (left != right) return left > right ? 1 : -1;
  if (a.y() != b.y()) return a.y() > b.y() ? 1 : -1;  // d/dp_x of the determinant is a_y - b_y
  if (a.x() != b.x()) return b.x() > a.x() ? 1 : -1;  // d/dp_y is b_x - a_x
  return 0;
}

}  // namespace

void InsideTest::reset(const CellView& cell) {
  cell_ = cell;
  lower_ = upper_ = vertex(0);
  for (int v = 1; v < cell.vertex_count; ++v) {
    lower_ = lower_.cwiseMin(vertex(v));
    upper_ = upper_.cwiseMax(vertex(v));
  }
  // About one column for two faces, as one looks at the upper and the lower side; but not more than a face is wide along either axis.
  const int face_count = static_cast<int>(cell.faces->size());
  const int per_axis = std::max(1, static_cast<int>(std::sqrt(face_count / 2.0)));
  const double longest = std::max({upper_.x() - lower_.x(), upper_.y() - lower_.y(), 1e-300});
  for (int a = 0; a < 2; ++a) {
    const double extent = upper_[a] - lower_[a];
    columns_[a] = std::max(1, static_cast<int>(per_axis * extent / longest));
    per_length_[a] = extent > 0 ? columns_[a] / extent : 0;
  }

  // Counting sort: the count of each column, its start, its faces.
  begin_.assign(static_cast<std::size_t>(columns_[0]) * columns_[1] + 1, 0);
  const auto for_columns = [&](int f, const auto& visit) {
    const auto& face = (*cell_.faces)[f];
    const Vector3 a = vertex(face[0]), b = vertex(face[1]), c = vertex(face[2]);
    const Vector3 low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    const auto first = column(low.x(), low.y()), last = column(high.x(), high.y());
    for (int j = first[1]; j <= last[1]; ++j)
      for (int i = first[0]; i <= last[0]; ++i) visit(static_cast<std::size_t>(j) * columns_[0] + i);
  };
  for (int f = 0; f < face_count; ++f) for_columns(f, [&](std::size_t c) { ++begin_[c]; });
  int sum = 0;
  for (int& entry : begin_) sum += entry, entry = sum;  // one past the end; filling backwards turns it into the start
  faces_.resize(sum);
  for (int f = face_count - 1; f >= 0; --f) for_columns(f, [&](std::size_t c) { faces_[--begin_[c]] = f; });
}

std::array<int, 2> InsideTest::column(double x, double y) const {
  return {std::clamp(static_cast<int>((x - lower_.x()) * per_length_[0]), 0, columns_[0] - 1),
          std::clamp(static_cast<int>((y - lower_.y()) * per_length_[1]), 0, columns_[1] - 1)};
}

bool InsideTest::contains(const Vector3& p) const {
  for (int a = 0; a < 3; ++a)
    if (!(p[a] >= lower_[a] && p[a] <= upper_[a])) return false;
  const auto [i, j] = column(p.x(), p.y());
  const std::size_t c = static_cast<std::size_t>(j) * columns_[0] + i;
  int above = 0, along_line = 0;  // crossings of the ray upwards, and of the whole vertical line; +1 outwards, -1 inwards
  for (int k = begin_[c]; k < begin_[c + 1]; ++k) {
    std::array<int, 3> face = (*cell_.faces)[faces_[k]];
    const std::array<Vector3, 3> x{vertex(face[0]), vertex(face[1]), vertex(face[2])};
    int facing = 0;
    bool crossed = true;
    for (int e = 0; e < 3 && crossed; ++e) {
      const int n = (e + 1) % 3;
      const int s = face[e] < face[n] ? side(x[e], x[n], p) : -side(x[n], x[e], p);
      crossed = s != 0 && (e == 0 || s == facing);
      facing = s;
    }
    if (!crossed) continue;
    along_line += facing;
    // Height of p over the plane of the face, times a positive factor, along the face's normal. On the face: as if p were outside.
    const double height = (x[1] - x[0]).cross(x[2] - x[0]).dot(p - x[0]);
    if (facing > 0 ? height < 0 : height >= 0) above += facing;
  }
  // A closed surface is left as often as it is entered. If rounding has broken that, ask the slow way.
  if (along_line != 0) return winding_number(cell_, p) > 0.5;
  return above > 0;
}

double winding_number(const CellView& cell, const Vector3& point) {
  double sum = 0;
  for (const auto& face : *cell.faces) {
    const auto corner = [&](int c) {
      const Vector3 d = Eigen::Map<const Vector3>(cell.positions + 3 * face[c]) - point;
      return Vec3<double>{d.x(), d.y(), d.z()};
    };
    sum += half_solid_angle(corner(0), corner(1), corner(2));
  }
  return sum / (2 * std::numbers::pi);
}

}  // namespace corpuscle
