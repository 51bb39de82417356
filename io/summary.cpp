#include "io/summary.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "io/durable.hpp"
#include "physics/statistics/ellipsoid.hpp"

namespace corpuscle {

SeriesSummary::SeriesSummary(const LatticeParameters& lattice, double discard) : discard_(discard), reference_area_(Summary::none) {
  scene_.capillary_number = lattice.capillary_number;
  scene_.reynolds_number = lattice.reynolds_number;
  scene_.phi_geometric = lattice.phi_geometric;
  scene_.phi_nominal = lattice.phi_nominal;
  scene_.phi_effective = lattice.phi_effective;
  scene_.si = lattice.si;
  for (const auto& type : lattice.cells) {
    scene_.cell_count += type.count;
    scene_.effective_radius.emplace_back(type.name, type.effective_radius);
    if (type.count > 0) reference_area_ = type.area;
  }
}

void SeriesSummary::add(const Sample& sample) {
  Row row{sample.step,
          sample.strain,
          sample.relative_viscosity,
          sample.wall_relative_viscosity,
          sample.bulk_relative_viscosity,
          sample.normal_stress_difference_1,
          sample.normal_stress_difference_2,
          sample.particle_pressure,
          sample.mean_deformation,
          Summary::none,
          Summary::none,
          Summary::none,
          Summary::none};
  if (scene_.cell_count == 1 && sample.cells.size() == 1) {
    const auto fit = statistics::fit_ellipsoid(sample.cells[0].gyration);
    row.deformation = fit.deformation;
    // An axis has the period pi: average the doubled angle as a vector, or angles around +-90 degrees would cancel.
    row.cos_twice_inclination = std::cos(2 * fit.inclination);
    row.sin_twice_inclination = std::sin(2 * fit.inclination);
    row.area_ratio = sample.cells[0].area / reference_area_;
  }
  rows_.push_back(row);
  scene_.steps = sample.step;
  scene_.strain = sample.strain;
  scene_.volume_drift_max = std::fmax(scene_.volume_drift_max, sample.volume_drift_max);
  scene_.area_drift_max = std::fmax(scene_.area_drift_max, sample.area_drift_max);
}

std::vector<double> SeriesSummary::save() const {
  std::vector<double> saved{scene_.volume_drift_max, scene_.area_drift_max};
  for (const Row& row : rows_) {
    saved.push_back(static_cast<double>(row.step));
    for (const auto column : columns) saved.push_back(row.*column);
  }
  return saved;
}

void SeriesSummary::restore(const std::vector<double>& saved) {
  const std::size_t width = 1 + columns.size();
  if (saved.size() < 2 || (saved.size() - 2) % width != 0) throw OutputError("The checkpoint's summary doesn't have the form that this version reads");
  scene_.volume_drift_max = saved[0];
  scene_.area_drift_max = saved[1];
  rows_.clear();
  for (std::size_t at = 2; at < saved.size(); at += width) {
    Row row{};
    row.step = static_cast<std::int64_t>(saved[at]);
    for (std::size_t i = 0; i < columns.size(); ++i) row.*columns[i] = saved[at + 1 + i];
    rows_.push_back(row);
  }
  if (!rows_.empty()) {
    scene_.steps = rows_.back().step;
    scene_.strain = rows_.back().strain;
  }
  recent_rows_ = 0;
}

std::size_t SeriesSummary::first_averaged() const {
  if (rows_.empty()) return 0;
  const auto begin = static_cast<double>(rows_.front().step);
  const double from = begin + discard_ * (static_cast<double>(rows_.back().step) - begin);
  const auto found = std::find_if(rows_.begin(), rows_.end(), [&](const Row& row) { return static_cast<double>(row.step) >= from; });
  return static_cast<std::size_t>(found - rows_.begin());
}

statistics::MeanError SeriesSummary::mean_of(double Row::* quantity) const {
  std::vector<double> values;
  for (std::size_t i = first_averaged(); i < rows_.size(); ++i) values.push_back(rows_[i].*quantity);
  return statistics::mean_error(values);
}

statistics::MeanError SeriesSummary::relative_viscosity() const {
  // A drifting series costs up to n^2/4 operations; done anew for each of n samples, that would be felt.
  if (50 * rows_.size() >= 51 * recent_rows_) {
    recent_viscosity_ = mean_of(&Row::relative_viscosity);
    recent_rows_ = rows_.size();
  }
  return recent_viscosity_;
}

Summary SeriesSummary::result() const {
  Summary summary = scene_;
  const std::size_t first = first_averaged();
  if (first < rows_.size()) {
    summary.averaged_from_strain = rows_[first].strain;
    summary.averaged_to_strain = rows_.back().strain;
    summary.averaged_samples = static_cast<std::int64_t>(rows_.size() - first);
  }
  summary.relative_viscosity = mean_of(&Row::relative_viscosity);
  summary.wall_relative_viscosity = mean_of(&Row::wall_relative_viscosity);
  summary.bulk_relative_viscosity = mean_of(&Row::bulk_relative_viscosity);
  summary.normal_stress_difference_1 = mean_of(&Row::normal_stress_difference_1);
  summary.normal_stress_difference_2 = mean_of(&Row::normal_stress_difference_2);
  summary.particle_pressure = mean_of(&Row::particle_pressure);
  summary.mean_deformation = mean_of(&Row::mean_deformation);
  summary.converged = summary.relative_viscosity.converged;
  if (scene_.cell_count == 1) {
    summary.deformation = mean_of(&Row::deformation).mean;
    summary.area_ratio = mean_of(&Row::area_ratio).mean;
    summary.inclination = std::atan2(mean_of(&Row::sin_twice_inclination).mean, mean_of(&Row::cos_twice_inclination).mean) / 2;
    summary.intrinsic_viscosity = (summary.relative_viscosity.mean - 1) / summary.phi_nominal;
    summary.intrinsic_viscosity_error = summary.relative_viscosity.error / summary.phi_nominal;
  }
  return summary;
}

Summary summarise(const std::vector<Sample>& samples, const LatticeParameters& lattice, double discard) {
  SeriesSummary series(lattice, discard);
  for (const auto& sample : samples) series.add(sample);
  return series.result();
}

void write_summary(const std::filesystem::path& path, const Summary& summary) {
  nlohmann::ordered_json json;  // NaN and infinity become null
  const auto with_error = [&](const std::string& name, const statistics::MeanError& value) {
    json[name] = value.mean;
    json[name + "_error"] = value.error;
  };
  json["capillary_number"] = summary.capillary_number;
  json["reynolds_number"] = summary.reynolds_number;
  json["phi_geometric"] = summary.phi_geometric;
  json["phi_nominal"] = summary.phi_nominal;
  json["phi_effective"] = summary.phi_effective;
  json["effective_radius"] = nlohmann::ordered_json::object();
  for (const auto& [name, radius] : summary.effective_radius) json["effective_radius"][name] = radius;
  json["cell_count"] = summary.cell_count;
  json["steps"] = summary.steps;
  json["strain"] = summary.strain;
  json["stopped_by"] = summary.stopped_by;
  json["warnings"] = summary.warnings;
  with_error("relative_viscosity", summary.relative_viscosity);
  json["viscosity_resolution_error"] = summary.viscosity_resolution_error.value;
  json["viscosity_resolution_error_uncertainty"] = summary.viscosity_resolution_error.uncertainty;
  json["viscosity_resolution_error_reason"] = summary.viscosity_resolution_error.reason;
  with_error("wall_relative_viscosity", summary.wall_relative_viscosity);
  with_error("bulk_relative_viscosity", summary.bulk_relative_viscosity);
  with_error("normal_stress_difference_1", summary.normal_stress_difference_1);
  with_error("normal_stress_difference_2", summary.normal_stress_difference_2);
  with_error("particle_pressure", summary.particle_pressure);
  with_error("mean_deformation", summary.mean_deformation);
  json["averaged_from_strain"] = summary.averaged_from_strain;
  json["averaged_to_strain"] = summary.averaged_to_strain;
  json["averaged_samples"] = summary.averaged_samples;
  json["converged"] = summary.converged;
  json["correlation_time_samples"] = summary.relative_viscosity.correlation_time;
  json["volume_drift_max"] = summary.volume_drift_max;
  json["area_drift_max"] = summary.area_drift_max;
  if (summary.cell_count == 1) {
    json["deformation"] = summary.deformation;
    json["inclination"] = summary.inclination;
    json["intrinsic_viscosity"] = summary.intrinsic_viscosity;
    json["intrinsic_viscosity_error"] = summary.intrinsic_viscosity_error;
    json["area_ratio"] = summary.area_ratio;
  }
  for (const auto& [name, unit] : named_units(summary.si)) json[name] = unit;
  json["wall_seconds"] = summary.wall_seconds;
  json["mlups"] = summary.mlups;
  json["threads"] = summary.threads;
  json["bytes_peak"] = summary.bytes_peak;
  for (const auto& part : summary.profile) json["profile"].push_back({{"operator", part.name}, {"calls", part.calls}, {"seconds", part.seconds}});

  replace_file(path, json.dump(2) + "\n", "the summary");
}

}  // namespace corpuscle
