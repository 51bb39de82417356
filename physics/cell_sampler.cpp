#include "physics/cell_sampler.hpp"

#include "kernels/vec3.hpp"

namespace corpuscle {
namespace {

using CellValues = Kokkos::View<double* [26], Kokkos::LayoutRight, MemSpace>;
constexpr int centre = 0, velocity = 3, gyration = 6, stresslet = 12, volume = 21, area = 22, extent = 23;

/// One thread a cell: sampling is rare, and the sums have the same bits for any number of threads.
struct MembraneStress {
  int first_vertex, first_cell, vertices;
  VertexVectors x, force;
  CellValues out;
  KOKKOS_FUNCTION void operator()(const int i) const {
    const int base = first_vertex + i * vertices;
    double s[9] = {};
    for (int v = base; v < base + vertices; ++v)
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) s[3 * a + b] -= force(v, a) * (x(v, b) - x(base, b));
    for (int k = 0; k < 9; ++k) out(first_cell + i, stresslet + k) = s[k];
  }
};

struct ContactStress {
  int first_vertex, first_cell, vertices;
  PeriodicBox box;
  Repulsion repulsion;
  NeighbourRows rows;
  VertexVectors x;
  CellValues out;
  KOKKOS_FUNCTION void operator()(const int i) const {
    const int base = first_vertex + i * vertices;
    double s[9] = {};
    for (int v = base; v < base + vertices; ++v) {
      for (int n = rows.begin(v); n < rows.begin(v + 1); ++n) {
        const PairVector pair(box, x, v, rows.list(n));
        const double scale = 0.5 * pair_force_scale(repulsion, pair);
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) s[3 * a + b] -= scale * pair.d[a] * pair.d[b];
      }
      if (box.walls) {
        const double above = x(v, 2), below = box.length[2] - x(v, 2);
        s[8] -= repulsion.magnitude(above) * above + repulsion.magnitude(below) * below;
      }
    }
    for (int k = 0; k < 9; ++k) out(first_cell + i, stresslet + k) += s[k];
  }
};

/// Moments of the enclosed volume as a sum over tetrahedra (origin, a, b, c): V = det/6, int x = V (a+b+c)/4,
/// int x x^T = V/20 (s s^T + a a^T + b b^T + c c^T), s = a + b + c.
struct Shape {
  int first_vertex, first_cell, vertices, faces;
  FaceTable face;
  VertexVectors x, u;
  CellValues out;
  KOKKOS_FORCEINLINE_FUNCTION Vec3<double> at(int base, int v, const Vec3<double>& origin) const {
    return Vec3<double>{x(base + v, 0), x(base + v, 1), x(base + v, 2)} - origin;
  }
  KOKKOS_FUNCTION void operator()(const int i) const {
    const int base = first_vertex + i * vertices, cell = first_cell + i;
    double mean_velocity[3] = {}, low[3], high[3];
    for (int k = 0; k < 3; ++k) low[k] = high[k] = x(base, k);
    for (int v = base; v < base + vertices; ++v)
      for (int k = 0; k < 3; ++k) {
        mean_velocity[k] += u(v, k) / vertices;
        low[k] = x(v, k) < low[k] ? x(v, k) : low[k];
        high[k] = x(v, k) > high[k] ? x(v, k) : high[k];
      }
    const Vec3<double> first{x(base, 0), x(base, 1), x(base, 2)};
    double v_sum = 0, a_sum = 0;
    Vec3<double> moment{0, 0, 0};
    double second[6] = {};
    for (int f = 0; f < faces; ++f) {
      const Vec3<double> a = at(base, face(f, 0), first), b = at(base, face(f, 1), first), c = at(base, face(f, 2), first);
      const Vec3<double> normal = cross(b - a, c - a), s = a + b + c;
      const double v = dot(a, normal) / 6;
      v_sum += v;
      a_sum += 0.5 * Kokkos::sqrt(dot(normal, normal));
      moment = moment + (v / 4) * s;
      const double w = v / 20;
      second[0] += w * (s.x * s.x + a.x * a.x + b.x * b.x + c.x * c.x);
      second[1] += w * (s.y * s.y + a.y * a.y + b.y * b.y + c.y * c.y);
      second[2] += w * (s.z * s.z + a.z * a.z + b.z * b.z + c.z * c.z);
      second[3] += w * (s.x * s.y + a.x * a.y + b.x * b.y + c.x * c.y);
      second[4] += w * (s.x * s.z + a.x * a.z + b.x * b.z + c.x * c.z);
      second[5] += w * (s.y * s.z + a.y * a.z + b.y * b.z + c.y * c.z);
    }
    const double m[3] = {moment.x / v_sum, moment.y / v_sum, moment.z / v_sum};
    const double outer[6] = {m[0] * m[0], m[1] * m[1], m[2] * m[2], m[0] * m[1], m[0] * m[2], m[1] * m[2]};
    for (int k = 0; k < 3; ++k) {
      out(cell, centre + k) = x(base, k) + m[k];
      out(cell, velocity + k) = mean_velocity[k];
      out(cell, extent + k) = high[k] - low[k];
    }
    for (int k = 0; k < 6; ++k) out(cell, gyration + k) = second[k] / v_sum - outer[k];
    out(cell, volume) = v_sum;
    out(cell, area) = a_sum;
  }
};

}  // namespace

CellSampler::CellSampler(const Cells& cells, const PeriodicBox& box) : box_(box), values_("cell_values", cells.cell_count()) {
  for (const auto& type : cells.types()) faces_.push_back(faces_on_device(type.reference));
}

void CellSampler::measure_membrane_stress(const Cells& cells) {
  for (const auto& t : cells.types())
    Kokkos::parallel_for("sample_membrane_stress", Kokkos::RangePolicy<ExecSpace>(0, t.count),
                         MembraneStress{t.first_vertex, t.first_cell, t.vertices(), cells.positions(), cells.forces(), values_});
}

void CellSampler::measure_contact_stress(const Cells& cells, const Contact& contact) {
  const Repulsion repulsion{contact.parameters().strength, contact.parameters().range};
  for (const auto& t : cells.types())
    Kokkos::parallel_for("sample_contact_stress", Kokkos::RangePolicy<ExecSpace>(0, t.count),
                         ContactStress{t.first_vertex, t.first_cell, t.vertices(), box_, repulsion, contact.neighbours(), cells.positions(), values_});
}

void CellSampler::measure_shape(const Cells& cells) {
  for (std::size_t i = 0; i < cells.types().size(); ++i) {
    const auto& t = cells.types()[i];
    Kokkos::parallel_for("sample_shape", Kokkos::RangePolicy<ExecSpace>(0, t.count),
                         Shape{t.first_vertex, t.first_cell, t.vertices(), t.faces(), faces_[i], cells.positions(), cells.velocities(), values_});
  }
}

std::vector<CellSample> CellSampler::collect() const {
  const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, values_);
  std::vector<CellSample> samples(host.extent(0));
  for (std::size_t c = 0; c < samples.size(); ++c) {
    auto& s = samples[c];
    for (int k = 0; k < 3; ++k) s.centre[k] = host(c, centre + k), s.velocity[k] = host(c, velocity + k), s.extent[k] = host(c, extent + k);
    for (int k = 0; k < 6; ++k) s.gyration[k] = host(c, gyration + k);
    for (int k = 0; k < 9; ++k) s.stresslet[k] = host(c, stresslet + k);
    s.volume = host(c, volume);
    s.area = host(c, area);
  }
  return samples;
}

}  // namespace corpuscle
