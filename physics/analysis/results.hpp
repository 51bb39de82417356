// What an analysis finds: numbers, curves, fits and tensors under fixed names (the tables of catalogue.cpp; docs/analysis.md says what each one is).
// Times in strains, lengths in radii r, velocities in shear_rate r, stresses in eta_0 shear_rate, diffusivities in shear_rate r^2.
#pragma once
#include <string>
#include <vector>

#include "physics/statistics/equilibration.hpp"
#include "physics/statistics/estimate.hpp"
#include "physics/statistics/fit.hpp"

namespace corpuscle::analysis {

/// Results that are computed, or refused, together.
enum class Group { rheology, walls, velocity, gap, diffusion, stress, shape, motion, structure, drift };

struct NamedEstimate {
  std::string name;
  Group group{};
  std::string unit, description;
  statistics::Estimate estimate{};
};

struct NamedCurve {
  std::string name;
  Group group{};
  std::string x_unit, unit, x_label, label, description;  ///< labels may contain mathtext, as matplotlib reads it
  statistics::Curve curve{};
};

struct NamedFit {
  std::string name;
  Group group{};
  std::string model, curve;  ///< formula; name of the fitted curve
  statistics::Fit fit{};
  double from = statistics::not_a_number, to = statistics::not_a_number;  ///< range of x that was fitted
};

struct NamedTensor {
  std::string name;
  Group group{};
  std::string unit, description;
  Eigen::Matrix3d value = Eigen::Matrix3d::Constant(statistics::not_a_number), error = value;
  bool converged = false;
  std::string reason{};
};

enum class MeanFlow {
  uniform,   ///< shear_rate (z - H/2)
  measured,  ///< the time average of the cells' velocities in layers of z
};

enum class RateOf {
  walls,  ///< what the walls impose, on average over the gap
  bulk,   ///< the measured slope of the velocity profile in the bulk
};

/// What the user may choose. NaN: chosen from the data.
struct AnalysisOptions {
  double wall_layer = 4;                             ///< radii at each wall that are no bulk
  MeanFlow mean_flow = MeanFlow::measured;
  RateOf rate = RateOf::walls;                       ///< the unit of rates (analyse_referred)
  double discard = statistics::not_a_number;         ///< strain
  double longest_lag = statistics::not_a_number;     ///< strain; else a quarter of the steady part
};

/// What was used in the end.
struct AnalysisSettings {
  double wall_layer = 0;  ///< 0 without walls
  MeanFlow mean_flow = MeanFlow::measured;
  double discarded_strain = 0;
  double longest_lag = 0;
  double contact_distance = statistics::not_a_number;  ///< radii
  std::string contact_distance_from;                   ///< how it was chosen
  AnalysisOptions asked;
};

class Analysis {
 public:
  /// Every name with nothing in it.
  Analysis();

  AnalysisSettings settings;
  double start_up_strain = 0;  ///< where the steady part begins
  statistics::Equilibration start_up;
  std::vector<NamedEstimate> estimates;
  std::vector<NamedCurve> curves;
  std::vector<NamedFit> fits;
  std::vector<NamedTensor> tensors;
  std::vector<std::string> warnings;

  /// By name; a name that isn't in the catalogue is a mistake of the program (std::logic_error).
  statistics::Estimate& estimate(const std::string& name);
  const statistics::Estimate& estimate(const std::string& name) const;
  statistics::Curve& curve(const std::string& name);
  const statistics::Curve& curve(const std::string& name) const;
  NamedFit& fit(const std::string& name);
  const NamedFit& fit(const std::string& name) const;
  NamedTensor& tensor(const std::string& name);

  /// Says why nothing of a group can be computed.
  void refuse(Group group, const std::string& reason);
  /// Doubts all that is an average over the steady part.
  void doubt_averages(const std::string& reason);
};

}  // namespace corpuscle::analysis
