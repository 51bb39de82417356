// What `corpuscle stability` searches: parameters, the scenes they are searched in, and how a value of one becomes a probe.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/bisect.hpp"
#include "physics/stability_probe.hpp"

namespace corpuscle::app {

/// Conditions of a probe. Moduli in units of the viscosity eta_0 (lattice units), as all explicit limits of a viscous fluid are stated.
struct ProbeScene {
  enum class Kind { at_rest, in_flow, fluid_only } kind = Kind::at_rest;
  int delta_kernel = 3;
  VertexUpdate update = VertexUpdate::averaged;
  int coupling_every = 1;  ///< time steps from one coupling of membranes and fluid to the next
  double relaxation_time = 1;
  double edge = 1;        ///< mean edge of the mesh in lattice units
  double radius = 5;
  double phi = 0.45;      ///< effective volume fraction, in flow
  Precision precision = Precision::double_precision;
  CollisionKind collision = CollisionKind::bgk;
  double shear = 0, dilation = 0, bending = 0;  ///< kappa / eta_0
  double area = 0.25, volume = 0.5;             ///< responses of physics/stability_limits.hpp: what the global terms do in one step
  double contact = 0.3;                         ///< kappa_int / eta_0
  double mach = 0.1;                            ///< fluid only: wall velocity / speed of sound
  double capillary_number = 0;                  ///< > 0: states kappa_S of a cell in flow
  std::int64_t steps = 3000;                    ///< couplings

  /// Red cell: kappa_alpha = 2.5 kappa_S, kappa_B = kappa_S r^2/405, contact as stiff as kappa_S.
  void set_red_cell(double kappa);
};

/// One limit to find.
struct StabilityCase {
  std::string parameter;   ///< what --only selects: "kappa_S", "tau", ...
  std::string conditions;  ///< in words, unique within the parameter
  std::string unit;
  ProbeScene scene;        ///< everything but the parameter
  LimitSearch search;      ///< range of the searched variable
  std::function<void(ProbeScene&, double)> set;    ///< puts a value of the searched variable into the scene
  std::function<double(double)> shown;             ///< the searched variable as the parameter itself (identity unless it is searched as an inverse)
  bool smallest = false;   ///< the limit is the smallest stable value of the parameter, not the largest

  std::string id() const { return parameter + " | " + conditions; }
};

/// All cases in the order in which they are searched. Every vertex update that scenes know is among them.
std::vector<StabilityCase> stability_cases();

/// Runs probes; packs the dense scenes once. Kokkos must be running.
class Prober {
 public:
  StabilityVerdict probe(const ProbeScene& scene);
  /// lambda_max(M K) of physics/stability_estimate.hpp at rest; not a number where it has no meaning.
  double response(const ProbeScene& scene);

 private:
  struct Built;
  Built build(const ProbeScene& scene);
  std::map<std::string, std::vector<double>> packed_;
};

}  // namespace corpuscle::app
