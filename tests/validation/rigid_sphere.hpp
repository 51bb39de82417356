// A sphere in a cubic periodic box of fluid, in creeping flow: its drag, torque and stresslet, and the radius of the rigid sphere that would have them.
// The coupling's kernel has a width, so a shell of vertices of radius a acts like a rigid sphere of radius a_h > a. Used by the validation test and by
// perf/bench_hydrodynamic_radius.cpp. Everything is linear in the velocity: vertices stay where they are, speeds are 1e-4.
#pragma once
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/lattice_for.hpp"
#include "physics/coupling.hpp"
#include "physics/membrane.hpp"
#include "physics/mesh.hpp"

namespace corpuscle::rigid_sphere {

enum class Motion {
  translation,      ///< along x
  rotation,         ///< about x
  strain_diagonal,  ///< E = diag(1, -1, 0), axes along those of the box
  strain_shear      ///< E_xz = E_zx = 1/2
};
/// How the vertices are made to move together.
enum class Hold {
  rigid,    ///< each vertex on a spring to a place that moves as prescribed: at the end all have the prescribed velocity
  uniform,  ///< translation only: the same force on every vertex, which is the exact traction of a sphere
  elastic   ///< translation only: the same force on every vertex of a free capsule with a stiff membrane
};

struct Setup {
  double radius = 6;             ///< of the vertices, a
  int subdivision = 6;           ///< n
  int box = 36;                  ///< L
  int delta_kernel = 3;
  CollisionKind collision = CollisionKind::trt;
  double relaxation_time = 2;
  Motion motion = Motion::translation;
  Hold hold = Hold::rigid;
  int place = 0;                 ///< number of a quasi-random offset from the lattice and orientation of the mesh
};

struct Result {
  double hydrodynamic_radius = 0;  ///< a_h
  double velocity_spread = 0;      ///< root mean square deviation of the vertices' velocities from rigid motion, relative to their size
  std::int64_t steps = 0;
};

/// Drag of a cubic array over Stokes's, F/(6 pi eta a U), U relative to the mean velocity of the whole volume; x = a/L (Hasimoto, J. Fluid Mech. 5, 317 (1959)).
inline double hasimoto(double x) { return 1 / (1 - 2.8373 * x + 4.1888 * std::pow(x, 3) - 27.36 * std::pow(x, 6)); }
/// Torque of a cubic array over 8 pi eta a^3 Omega: the missing mean vorticity of a periodic flow slows the sphere by T/(6 eta V); next term (a/L)^10 (Zuzovsky, Adler, Brenner 1983).
inline double torque_factor(double x) { return 1 / (1 - 4 * std::numbers::pi / 3 * x * x * x); }
/// Particle stress/(2 eta E) of a simple cubic array (Zuzovsky, Adler, Brenner, Phys. Fluids 26, 1714 (1983); Nunan, Keller, J. Fluid Mech. 142, 269 (1984)).
inline double stress_factor(double x, Motion motion) {
  constexpr double a = 0.2857, b = -0.04655;
  const double phi = 4 * std::numbers::pi / 3 * x * x * x;
  if (motion == Motion::strain_diagonal) return 2.5 * phi / (1 - (1 - 60 * b) * phi + 12 * a * std::pow(phi, 5.0 / 3));
  return 2.5 * phi / (1 - (1 + 40 * b) * phi - 8 * a * std::pow(phi, 5.0 / 3));
}

/// x in (0, 0.4) with f(x) = value, f increasing.
template <class F>
double invert(const F& f, double value) {
  double low = 0, high = 0.4;
  for (int i = 0; i < 60; ++i) (f(0.5 * (low + high)) < value ? low : high) = 0.5 * (low + high);
  return 0.5 * (low + high);
}

/// Adds a constant force density to all nodes.
struct AddForce {
  VectorField<double> force;
  double fx, fy, fz;
  KOKKOS_FORCEINLINE_FUNCTION void operator()(const int node) const {
    force(node, 0) += fx;
    force(node, 1) += fy;
    force(node, 2) += fz;
  }
};

inline Result measure(const Setup& s) {
  constexpr double speed = 1e-4, pi = std::numbers::pi;
  FluidParameters fp;
  fp.nodes = {s.box, s.box, s.box};
  fp.halo = Coupling<double>::halo_width(s.delta_kernel);
  fp.collision = s.collision;
  fp.relaxation_time = s.relaxation_time;
  fp.walls = false;
  fp.needs_force = true;
  Fluid<double> fluid(fp);
  fluid.initialise();
  Coupling<double> coupling(fluid.grid(), false, s.delta_kernel);
  const double viscosity = (s.relaxation_time - 0.5) / 3, volume = std::pow(double(s.box), 3);

  const Mesh mesh = sphere_mesh(s.radius, s.subdivision);
  const int n = int(mesh.vertices.size());
  // Offsets: the sequence of the plastic number's powers fills the cell evenly. Orientations turn the mesh against the lattice.
  const auto fraction = [&](double step) { return std::fmod(0.5 + s.place * step, 1.0); };
  const Vector3 offset(fraction(0.8191725134), fraction(0.6710436067), fraction(0.5497004779));
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.1 * s.place, Vector3(1, 0.3 * s.place, 0.7).normalized()));
  std::vector<Vector3> arm;  // from the centre
  VertexVectors x("positions", n), u("velocities", n), f("forces", n);
  const auto xh = Kokkos::create_mirror_view(x), uh = Kokkos::create_mirror_view(u), fh = Kokkos::create_mirror_view(f);
  for (int v = 0; v < n; ++v) {
    arm.push_back(turn * mesh.vertices[v]);
    for (int k = 0; k < 3; ++k) xh(v, k) = s.box / 2 + offset[k] + arm[v][k];
  }
  Kokkos::deep_copy(x, xh);

  Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();  // the disturbance cancels the imposed strain on the sphere
  if (s.motion == Motion::strain_diagonal) gradient.diagonal() << -1, 1, 0;
  if (s.motion == Motion::strain_shear) gradient(0, 2) = gradient(2, 0) = -0.5;
  const double rate = speed / s.radius;
  std::vector<Vector3> target(n), lag(n, Vector3::Zero()), before(n, Vector3::Zero());
  for (int v = 0; v < n; ++v) {
    if (s.motion == Motion::translation) target[v] = speed * Vector3::UnitX();
    else if (s.motion == Motion::rotation) target[v] = rate * Vector3::UnitX().cross(arm[v]);
    else target[v] = rate * gradient * arm[v];
  }
  // Springs: an areal stiffness of half the viscosity, half of what the coupling holds stable (measured here for every kernel).
  const double spring = 0.5 * viscosity * 4 * pi * s.radius * s.radius / n;
  const double uniform = 6 * pi * viscosity * s.radius * speed / n;
  MembraneModuli moduli;
  moduli.law = StrainLawKind::neo_hookean;
  moduli.shear = 0.5 * viscosity;
  moduli.volume = 0.25 * s.radius / 3;
  const auto membrane = s.hold == Hold::elastic ? make_membrane(Mesh{arm, mesh.faces}, moduli, Precision::double_precision, 0, 1) : nullptr;

  const double relaxation = double(s.box) * s.box / (4 * pi * pi * viscosity);  // slowest viscous mode of the box
  const int every = std::max(10, int(relaxation / 2));
  Result result;
  double last = 0;
  int settled = 0;
  for (std::int64_t step = 1;; ++step) {
    // Force on the fluid.
    Vector3 total = Vector3::Zero();
    if (membrane) {
      Kokkos::deep_copy(x, xh);
      membrane->compute_forces(x, f);
      Kokkos::deep_copy(fh, f);
    }
    for (int v = 0; v < n; ++v)
      for (int k = 0; k < 3; ++k) {
        const double outer = k == 0 ? uniform : 0;
        fh(v, k) = s.hold == Hold::rigid ? spring * lag[v][k] : membrane ? fh(v, k) + outer : outer;
        total[k] += fh(v, k);
      }
    Kokkos::deep_copy(f, fh);
    coupling.spread(x, f, fluid.force());
    fluid.scatter_force();
    // The fluid as a whole stays at rest: velocities are relative to the mean over the volume.
    lattice_for("balance", fluid.grid(), interior(fluid.grid()), AddForce{fluid.force(), -total[0] / volume, -total[1] / volume, -total[2] / volume});
    fluid.collide_stream();
    fluid.gather_velocity();
    coupling.interpolate(x, u, fluid.velocity());
    Kokkos::deep_copy(uh, u);
    for (int v = 0; v < n; ++v) {
      const Vector3 now(uh(v, 0), uh(v, 1), uh(v, 2)), mean = 0.5 * (now + before[v]);  // blind to staggered momenta
      if (s.hold == Hold::rigid) lag[v] += target[v] - mean;
      if (membrane)
        for (int k = 0; k < 3; ++k) xh(v, k) += mean[k];
      before[v] = now;
    }
    if (step % every != 0) continue;

    Vector3 drift = Vector3::Zero();
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();  // sum F_a r_b
    for (int v = 0; v < n; ++v) {
      drift += before[v] / n;
      moment += Vector3(fh(v, 0), fh(v, 1), fh(v, 2)) * arm[v].transpose();
    }
    double spread = 0;
    for (int v = 0; v < n; ++v) spread += (before[v] - (s.hold == Hold::rigid ? target[v] : drift)).squaredNorm() / n;
    result.velocity_spread = std::sqrt(spread) / speed;
    const double length = s.box;
    if (s.motion == Motion::translation) {
      const double velocity = s.hold == Hold::rigid ? speed : drift[0];
      result.hydrodynamic_radius = length * invert([](double r) { return r * hasimoto(r); }, total[0] / (6 * pi * viscosity * velocity * length));
    } else if (s.motion == Motion::rotation) {
      const double torque = moment(2, 1) - moment(1, 2);
      result.hydrodynamic_radius = length * invert([](double r) { return r * r * r * torque_factor(r); }, torque / (8 * pi * viscosity * rate * volume));
    } else {
      const double stress = rate * (gradient.cwiseProduct(moment)).sum() / (2 * viscosity * rate * rate * gradient.squaredNorm() * volume);
      result.hydrodynamic_radius = length * invert([&](double r) { return stress_factor(r, s.motion); }, stress);
    }
    result.steps = step;
    if (!std::isfinite(total[0]) || step > 200 * every) throw std::runtime_error("the flow around the sphere does not settle");
    // What is left to come is about as much as came in the last half relaxation time, times 1/(e^0.5 - 1). Twice in a row: it may swing.
    settled = step > 4 * every && std::abs(result.hydrodynamic_radius - last) < 2e-4 ? settled + 1 : 0;
    if (settled == 2) return result;
    last = result.hydrodynamic_radius;
  }
}

}  // namespace corpuscle::rigid_sphere
