// summary.json: the numbers of a run that one wants first, each mean with an honest error.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "physics/resolution_error.hpp"
#include "physics/sample.hpp"
#include "physics/statistics/mean_error.hpp"
#include "physics/units.hpp"

namespace corpuscle {

/// Time of one operator of a run, or of a part of the host's work (corpuscle run --profile).
struct OperatorTime {
  std::string name;
  std::int64_t calls = 0;
  double seconds = 0;
};

/// What summary.json holds (docs/outputs.md). NaN where a number has no meaning; it's written as null.
struct Summary {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  double capillary_number = none;
  double reynolds_number = none;
  double phi_geometric = none;
  double phi_nominal = none;    ///< of the cells at their nominal radius
  double phi_effective = none;
  std::vector<std::pair<std::string, double>> effective_radius;  ///< hydrodynamic radius of each cell type, lattice units
  std::int64_t cell_count = 0;
  SiUnits si;              ///< one lattice unit in SI units, where the scene's [si] fixes it
  std::int64_t steps = 0;  ///< reached
  double strain = 0;       ///< reached

  double averaged_from_strain = none;  ///< the means below are over [from, to]; 0 at rest
  double averaged_to_strain = none;
  std::int64_t averaged_samples = 0;
  statistics::MeanError relative_viscosity;
  statistics::MeanError wall_relative_viscosity;
  statistics::MeanError bulk_relative_viscosity;
  statistics::MeanError normal_stress_difference_1;
  statistics::MeanError normal_stress_difference_2;
  statistics::MeanError particle_pressure;
  statistics::MeanError mean_deformation;
  double volume_drift_max = none;  ///< over the whole run
  double area_drift_max = none;
  bool converged = false;          ///< the error of relative_viscosity can be trusted

  // One cell only, means over the same window.
  double deformation = none;
  double inclination = none;          ///< rad, against the flow direction
  double intrinsic_viscosity = none;  ///< (relative_viscosity - 1)/phi_nominal
  double intrinsic_viscosity_error = none;
  double area_ratio = none;           ///< A/A_0

  // Filled in by the caller, who knows how the run went.
  double wall_seconds = none;
  double mlups = none;                ///< million lattice node updates per second
  std::int64_t threads = 0;
  std::int64_t bytes_peak = 0;        ///< largest memory of the process
  ResolutionError viscosity_resolution_error;  ///< from studies; beside the statistical errors above
  std::vector<std::string> warnings;  ///< of settings close to a stability limit
  std::string stopped_by;             ///< "end", "interrupt", "guard" ...
  std::vector<OperatorTime> profile;  ///< empty unless it was asked for
};

/// Accumulates samples during a run; keeps a few scalars of each.
class SeriesSummary {
 public:
  /// `discard`: fraction of the run so far that is left out of the means (RunSpec::discard).
  SeriesSummary(const LatticeParameters& lattice, double discard);
  /// Takes the next sample. With one cell, `sample.cells` gives its shape.
  void add(const Sample& sample);
  /// What has been added, as plain numbers for a checkpoint.
  std::vector<double> save() const;
  /// Goes on from `save`. @throws OutputError when the numbers can't come from there.
  void restore(const std::vector<double>& saved);
  /// Means over the last part of what was added; the caller's fields are left empty.
  Summary result() const;
  /// Just relative_viscosity of result(), for the progress line: cheap to call with every sample, and up to 2 % of the samples old.
  statistics::MeanError relative_viscosity() const;

 private:
  /// Scalars of one sample that are averaged.
  struct Row {
    std::int64_t step;
    double strain, relative_viscosity, wall_relative_viscosity, bulk_relative_viscosity, normal_stress_difference_1, normal_stress_difference_2,
        particle_pressure, mean_deformation, deformation, cos_twice_inclination, sin_twice_inclination, area_ratio;
  };
  static constexpr std::array columns{&Row::strain,
                                      &Row::relative_viscosity,
                                      &Row::wall_relative_viscosity,
                                      &Row::bulk_relative_viscosity,
                                      &Row::normal_stress_difference_1,
                                      &Row::normal_stress_difference_2,
                                      &Row::particle_pressure,
                                      &Row::mean_deformation,
                                      &Row::deformation,
                                      &Row::cos_twice_inclination,
                                      &Row::sin_twice_inclination,
                                      &Row::area_ratio};
  std::size_t first_averaged() const;
  statistics::MeanError mean_of(double Row::* quantity) const;

  double discard_;
  Summary scene_;          ///< the fields that don't depend on the samples
  double reference_area_;  ///< of the only cell
  std::vector<Row> rows_;
  mutable statistics::MeanError recent_viscosity_;
  mutable std::size_t recent_rows_ = 0;  ///< samples when recent_viscosity_ was computed
};

/// The same from samples that were read back (io/run_file.hpp, read_series).
Summary summarise(const std::vector<Sample>& samples, const LatticeParameters& lattice, double discard);

/// Writes summary.json: to a temporary name first, so that the file is always whole. @throws OutputError.
void write_summary(const std::filesystem::path& path, const Summary& summary);

}  // namespace corpuscle
