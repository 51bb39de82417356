#include "physics/hydrodynamic_size.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"

namespace corpuscle {
namespace {

constexpr double thickness_per_shell = 3;  // a third of the thickness must be left
constexpr double volume_tolerance = 0.03;  // of mesh and shell together against the nominal volume: coarse meshes of smooth shapes stay below 0.015, sharp edges are far off

// The steady flow of a lattice Boltzmann fluid depends on the relaxation times through Lambda = (1/omega+ - 1/2)(1/omega- - 1/2) only (BGK: (tau - 1/2)^2), at distances of few
// nodes visibly. Measured for BGK at tau = 0.7, 1, 1.5: the shell falls with Lambda, within 0.02 alike for the three kernels.
constexpr double least_lambda = 0.04, largest_lambda = 1;
double shell_of_collision(double lambda) { return -0.24 * std::sqrt(lambda) - 0.11 * lambda; }

/// What the shell of the viscosity has more than that of the drag, over that of a plane.
constexpr double viscosity_over_plane = 0.36;

/// Unit outward normals of the vertices: normals of the faces, weighted with the angle at the vertex.
std::vector<Vector3> vertex_normals(const Mesh& mesh) {
  std::vector<Vector3> normals(mesh.vertices.size(), Vector3::Zero());
  for (const auto& face : mesh.faces)
    for (int c = 0; c < 3; ++c) {
      const Vector3 e1 = mesh.vertices[face[(c + 1) % 3]] - mesh.vertices[face[c]], e2 = mesh.vertices[face[(c + 2) % 3]] - mesh.vertices[face[c]];
      const Vector3 normal = e1.cross(e2);
      normals[face[c]] += std::atan2(normal.norm(), e1.dot(e2)) * normal.normalized();
    }
  for (auto& normal : normals) normal.normalize();
  return normals;
}

Vector3 area_vector(const Mesh& mesh, const std::array<int, 3>& face) {
  return (mesh.vertices[face[1]] - mesh.vertices[face[0]]).cross(mesh.vertices[face[2]] - mesh.vertices[face[0]]);
}

bool turned_over(const Mesh& before, const Mesh& after) {
  return std::any_of(before.faces.begin(), before.faces.end(), [&](const auto& face) { return area_vector(before, face).dot(area_vector(after, face)) <= 0; });
}

/// Thinnest part of a shape.
double thickness_of(const CellSpec& spec, double radius, const Mesh& mesh) {
  switch (spec.shape) {
    case ShapeKind::sphere: return 2 * radius;
    case ShapeKind::spheroid: return 2 * radius * std::min(spec.aspect_ratio, 1 / spec.aspect_ratio);
    case ShapeKind::red_cell: return 0.207 * radius;  // in the centre (mesh_shapes.cpp)
    default: return thinnest(mesh);
  }
}

}  // namespace

KernelShell kernel_shell(int delta_kernel) {
  switch (delta_kernel) {
    case 2: return {0.28, 0.37};
    case 3: return {0.34, 0.55};
    default: return {0.44, 0.94};
  }
}

double shell_thickness(const AccuracySpec& accuracy, double radius) {
  if (accuracy.shell_thickness) return *accuracy.shell_thickness;
  auto [plane, curvature] = kernel_shell(accuracy.delta_kernel);
  const double lambda = accuracy.collision == CollisionKind::trt ? accuracy.magic_parameter : std::pow(accuracy.relaxation_time - 0.5, 2);
  plane += shell_of_collision(std::clamp(lambda, least_lambda, largest_lambda)) - shell_of_collision(3.0 / 16);
  if (accuracy.cell_size == CellSize::mesh) return plane + curvature / radius;
  // a + plane + curvature/a = radius
  const double half = 0.5 * (radius - plane);
  return radius - (half + std::sqrt(std::max(0.0, half * half - curvature)));
}

double counted_shell(const AccuracySpec& accuracy, double radius) {
  const double drag = shell_thickness(accuracy, radius);
  if (accuracy.shell_thickness || accuracy.cell_size == CellSize::hydrodynamic || accuracy.counted_shell == CountedShell::drag) return drag;
  return drag + viscosity_over_plane * kernel_shell(accuracy.delta_kernel).plane;
}

Mesh inset(const Mesh& mesh, double distance) {
  Mesh result = mesh;
  const auto normals = vertex_normals(mesh);
  for (std::size_t v = 0; v < normals.size(); ++v) result.vertices[v] -= distance * normals[v];
  return result;
}

double thinnest(const Mesh& mesh) {
  const auto normals = vertex_normals(mesh);
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t v = 0; v < normals.size(); ++v) {
    const Vector3 direction = -normals[v];
    for (const auto& face : mesh.faces) {
      if (face[0] == int(v) || face[1] == int(v) || face[2] == int(v)) continue;
      const Vector3 normal = area_vector(mesh, face);
      const double along = normal.dot(direction);
      if (along <= 0) continue;  // leaves the body only through a face whose normal points along the ray
      const double t = normal.dot(mesh.vertices[face[0]] - mesh.vertices[v]) / along;
      if (t <= 0 || t >= shortest) continue;
      const Vector3 hit = mesh.vertices[v] + t * direction;
      bool inside = true;
      for (int c = 0; c < 3; ++c) {
        const Vector3& a = mesh.vertices[face[c]];
        inside = inside && normal.dot((mesh.vertices[face[(c + 1) % 3]] - a).cross(hit - a)) >= -1e-9 * normal.squaredNorm();
      }
      if (inside) shortest = t;
    }
  }
  return shortest;
}

Mesh make_cell_mesh(const CellSpec& spec, const AccuracySpec& accuracy, double radius, int frequency) {
  const Mesh nominal = make_mesh(spec, radius, frequency);
  const double shell = shell_thickness(accuracy, radius);
  if (accuracy.cell_size == CellSize::mesh || shell == 0) return nominal;
  const double thickness = thickness_of(spec, radius, nominal);
  const auto refuse = [&](const std::string& why) -> InputError {
    return InputError(fmt::format("accuracy.cell_size = \"hydrodynamic\" puts the mesh {:g} lattice units inside the surface of the cell, but {}; choose \"mesh\", or a larger "
                                  "accuracy.radius or a smaller accuracy.delta_kernel", shell, why));
  };
  if (thickness < thickness_per_shell * shell) {
    throw refuse(fmt::format("its thinnest part is {:.3g} thick and must be at least {:.3g}, so that a third of it is left (accuracy.radius >= {:.3g})", thickness,
                             thickness_per_shell * shell, std::ceil(accuracy.radius * thickness_per_shell * shell / thickness * 100) / 100));
  }
  const Mesh smaller = spec.shape == ShapeKind::sphere ? sphere_mesh(radius - shell, frequency) : inset(nominal, shell);
  const bool parallel = std::abs(mesh_effective_volume(smaller, shell) / mesh_volume(nominal) - 1) < volume_tolerance || spec.shape == ShapeKind::sphere;
  if (turned_over(nominal, smaller) || !parallel) throw refuse("the surface has edges that are sharper than that");
  return smaller;
}

}  // namespace corpuscle
