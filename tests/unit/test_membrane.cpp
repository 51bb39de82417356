#include "physics/membrane.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "core/random.hpp"
#include "core/simd.hpp"
#include "core/types.hpp"
#include "kernels/vec3.hpp"
#include "tests/catch.hpp"

using namespace corpuscle;

namespace {

MembraneModuli moduli(StrainLawKind law, double shear, double dilation, double bending, double area, double volume) {
  return {law, shear, dilation, bending, std::sqrt(3.) / 2, area, volume};
}

/// Forces on the host of several cells of the same type.
std::vector<std::vector<Vector3>> forces_of(const Mesh& reference, const MembraneModuli& m, Precision precision, const std::vector<std::vector<Vector3>>& cells,
                                            double scale = 1) {
  const int vertices = int(reference.vertices.size()), count = int(cells.size());
  VertexVectors x("x", vertices * count), f("f", vertices * count);
  auto host = Kokkos::create_mirror_view(x);
  for (int c = 0; c < count; ++c)
    for (int v = 0; v < vertices; ++v)
      for (int k = 0; k < 3; ++k) host(c * vertices + v, k) = cells[c][v][k];
  Kokkos::deep_copy(x, host);
  const auto membrane = make_membrane(reference, m, precision, 0, count);
  if (scale != 1) membrane->set_reference_scale(scale);
  membrane->compute_forces(x, f);
  const auto out = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace{}, f);
  std::vector<std::vector<Vector3>> result(count, std::vector<Vector3>(vertices));
  for (int c = 0; c < count; ++c)
    for (int v = 0; v < vertices; ++v) result[c][v] = Vector3(out(c * vertices + v, 0), out(c * vertices + v, 1), out(c * vertices + v, 2));
  return result;
}

/// A smooth, large and irregular deformation.
std::vector<Vector3> deform(const std::vector<Vector3>& x, int variant) {
  RandomStream random(7, variant);
  std::vector<Vector3> y = x;
  for (auto& p : y) {
    const Vector3 q = p;
    p += 0.15 * Vector3(std::sin(0.4 * q[1] + variant), 0.5 * q[0] * q[2] / 8, std::cos(0.3 * q[0]) + 0.1 * q[1]);
    for (int k = 0; k < 3; ++k) p[k] += 0.05 * random.uniform(-1, 1);
    p += Vector3(100 + 17 * variant, -40, 3);
  }
  return y;
}

}  // namespace

TEST_CASE("angle_of is atan2", "[membrane]") {
  for (double angle = -1.57; angle < 1.57; angle += 0.00731)
    CHECK(angle_of(2.5 * std::sin(angle), 2.5 * std::cos(angle)) == Approx(angle).epsilon(3e-15).margin(1e-16));
  for (double angle = 1.5; angle < 3.1; angle += 0.0371) CHECK(angle_of(std::sin(angle), std::cos(angle)) == Approx(angle).epsilon(1e-10));
}

TEST_CASE("Membrane forces are minus the gradient of the energy", "[membrane]") {
  const Mesh red = red_cell_mesh(4, 4), ball = sphere_mesh(4, 3);
  struct Case {
    const char* name;
    const Mesh* mesh;
    MembraneModuli m;
  };
  const Case cases[] = {
      {"skalak", &ball, moduli(StrainLawKind::skalak, 0.1, 0.3, 0, 0, 0)},
      {"neo-hookean", &ball, moduli(StrainLawKind::neo_hookean, 0.1, 0, 0, 0, 0)},
      {"bending", &red, moduli(StrainLawKind::skalak, 1e-12, 0, 0.2, 0, 0)},
      {"bending of a sphere", &ball, moduli(StrainLawKind::skalak, 1e-12, 0, 0.2, 0, 0)},
      {"area", &red, moduli(StrainLawKind::skalak, 1e-12, 0, 0, 0.5, 0)},
      {"volume", &red, moduli(StrainLawKind::skalak, 1e-12, 0, 0, 0, 0.5)},
      {"all", &red, moduli(StrainLawKind::skalak, 0.1, 0.3, 0.2, 0.7, 0.4)},
  };
  for (const auto& c : cases) {
    INFO(c.name);
    const auto x = deform(c.mesh->vertices, 1);
    const auto forces = forces_of(*c.mesh, c.m, Precision::double_precision, {x})[0];
    double scale = 0;
    for (const auto& f : forces) scale = std::max(scale, f.norm());
    REQUIRE(scale > 1e-4);
    const double h = 1e-4;
    for (std::size_t v = 0; v < x.size(); v += 5)
      for (int k = 0; k < 3; ++k) {
        const auto energy = [&](double shift) {
          auto y = x;
          y[v][k] += shift;
          return membrane_energy(*c.mesh, c.m, y).total();
        };
        const double derivative = (8 * (energy(h) - energy(-h)) - (energy(2 * h) - energy(-2 * h))) / (12 * h);
        CHECK(forces[v][k] == Approx(-derivative).margin(1e-6 * scale));
      }
  }
}

TEST_CASE("Membrane forces of every lane and precision agree, sum to zero and exert no torque", "[membrane]") {
  const Mesh red = red_cell_mesh(4, 4);
  const auto m = moduli(StrainLawKind::skalak, 0.1, 0.3, 0.02, 0.7, 0.4);
  std::vector<std::vector<Vector3>> cells;
  for (int c = 0; c < 11; ++c) cells.push_back(deform(red.vertices, c));  // not a multiple of any SIMD width
  const auto together = forces_of(red, m, Precision::double_precision, cells);
  const auto single = forces_of(red, m, Precision::single_precision, cells);
  for (int c = 0; c < 11; ++c) {
    const auto alone = forces_of(red, m, Precision::double_precision, {cells[c]})[0];
    Vector3 sum = Vector3::Zero(), torque = Vector3::Zero();
    double scale = 0, worst = 0, worst_single = 0;
    for (std::size_t v = 0; v < alone.size(); ++v) {
      sum += alone[v];
      torque += (cells[c][v] - cells[c][0]).cross(alone[v]);
      scale = std::max(scale, alone[v].norm());
      worst = std::max(worst, (alone[v] - together[c][v]).norm());
      worst_single = std::max(worst_single, (alone[v] - single[c][v]).norm());
    }
    CHECK(worst == 0);
    CHECK(worst_single < 2e-5 * scale);
    CHECK(sum.norm() < 1e-13 * scale * alone.size());
    CHECK(torque.norm() < 1e-12 * scale * alone.size());
  }
}

TEST_CASE("Bending forces stay bounded where a triangle is squeezed to nothing, and sum to zero there too", "[membrane]") {
  const Mesh red = red_cell_mesh(5, 5);
  const auto m = moduli(StrainLawKind::skalak, 1e-12, 0, 0.02, 0, 0);
  const auto& face = red.faces[40];
  const Vector3 &a = red.vertices[face[0]], &b = red.vertices[face[1]], &c = red.vertices[face[2]];
  const Vector3 foot = b + (c - b) * (a - b).dot(c - b) / (c - b).squaredNorm(), up = (b - a).cross(c - a).normalized();
  double before = 0, largest = 0;
  for (const double height : {0.5, 0.2, 0.05, 1e-2, 1e-3, 1e-5, 0.0}) {
    // The corner comes to its foot on the opposite edge, from above: folded by more and more.
    auto x = red.vertices;
    x[face[0]] = foot + height * ((a - foot).normalized() + 0.3 * up);
    const auto forces = forces_of(red, m, Precision::double_precision, {x})[0];
    Vector3 sum = Vector3::Zero(), torque = Vector3::Zero();
    double scale = 0;
    for (std::size_t v = 0; v < x.size(); ++v) {
      sum += forces[v];
      torque += (x[v] - x[0]).cross(forces[v]);
      scale = std::max(scale, forces[v].norm());
    }
    INFO("height " << height << ", largest force " << scale);
    CHECK(sum.norm() < 1e-12 * (scale + 1e-12));
    CHECK(torque.norm() < 1e-10 * (scale + 1e-12));
    largest = std::max(largest, scale);
    if (height == 0.05) before = scale;
  }
  // A moment of pi at an edge of length 1, over the height at 20 % of the area (0.17 of edge 1), from each of the six triangles around the corner; unbounded it were thousands.
  CHECK(before > 0);
  CHECK(largest < 6 * 2 * m.bending_constant * m.bending * 3.15 / 0.17);
}

TEST_CASE("No force at the reference shape, in any orientation and at any reference scale", "[membrane]") {
  const Mesh red = red_cell_mesh(4, 4);
  const auto m = moduli(StrainLawKind::skalak, 0.1, 0.3, 0.02, 0.7, 0.4);
  for (const double scale : {1.0, 0.6}) {
    auto x = red.vertices;
    const Eigen::Quaterniond turn = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2).normalized();
    for (auto& p : x) p = turn * (scale * p) + Vector3(1000, 20, -7);
    const auto forces = forces_of(red, m, Precision::double_precision, {x}, scale);
    for (const auto& f : forces[0]) CHECK(f.norm() < 1e-11);
  }
}

TEST_CASE("Uniaxial tension: transverse stretch of both laws", "[membrane]") {
  // A patch under l1, l2 has no transverse force where the law's stress vanishes: NH l2 = l1^-1/2, SK l2^2 = (1 + C l1^2)/(1 + C l1^4). A sphere mesh scaled by (l1, l2) in
  // the tangent plane of an isotropic patch is tested through the energy's derivative with respect to l2.
  const Mesh ball = sphere_mesh(1, 8);
  const auto slope = [&](const MembraneModuli& m, double l1, double l2) {
    const auto density = [&](double s) {
      // The triangle around the pole: stretched in x and y.
      auto x = ball.vertices;
      for (auto& p : x) p = Vector3(l1 * p[0], s * p[1], 0);
      Mesh flat{ball.vertices, ball.faces};
      for (auto& p : flat.vertices) p[2] = 0;
      Mesh cap;
      cap.vertices = flat.vertices;
      for (const auto& f : ball.faces)
        if (ball.vertices[f[0]][2] > 0.5 && ball.vertices[f[1]][2] > 0.5 && ball.vertices[f[2]][2] > 0.5) cap.faces.push_back(f);
      auto no_bending = m;
      no_bending.bending = no_bending.global_area = no_bending.volume = 0;
      double sum = 0;
      for (const auto& f : cap.faces) sum += membrane_energy(Mesh{cap.vertices, {f, {f[0], f[2], f[1]}}}, no_bending, x).strain;
      return sum;
    };
    return (density(l2 + 1e-5) - density(l2 - 1e-5)) / 2e-5;
  };
  for (const double l1 : {1.1, 1.5, 2.0}) {
    const auto nh = moduli(StrainLawKind::neo_hookean, 3, 0, 0, 0, 0);
    CHECK(slope(nh, l1, 1 / std::sqrt(l1)) == Approx(0).margin(1e-6));
    for (const double C : {0.5, 1.0, 10.0}) {
      const auto sk = moduli(StrainLawKind::skalak, 3, 3 * C, 0, 0, 0);
      CHECK(slope(sk, l1, std::sqrt((1 + C * l1 * l1) / (1 + C * std::pow(l1, 4)))) == Approx(0).margin(1e-6));
    }
  }
}

TEST_CASE("Membranes of several cells are computed at once where the processor has wide registers", "[membrane]") {
#if defined(__AVX512F__) || defined(__AVX2__) || defined(__ARM_NEON)
  // However Kokkos was configured: with a single lane every suspension would be slower by far, and nothing else would show it.
  if (runs_on_host) {
    CHECK(int(HostPack<double>::size()) > 1);
    CHECK(int(HostPack<float>::size()) > 1);
  }
#else
  SUCCEED("this processor has none that Kokkos knows");
#endif
}
