#include "io/sweep_analysis.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "core/error.hpp"
#include "core/version.hpp"
#include "io/analysis_file.hpp"
#include "io/hdf5.hpp"

namespace corpuscle {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array run_numbers{"capillary_number", "phi_effective", "phi_geometric", "cell_count", "radius", "effective_radius", "strain"};

double number(const Json& value) { return value.is_number() ? value.get<double>() : statistics::not_a_number; }

analysis::RunOutcome outcome_of(const AnalysedRun& run) {
  const Json& facts = run.analysis.at("run");
  return {.directory = run.directory,
          .capillary_number = number(facts.at("capillary_number")),
          .phi_effective = number(facts.at("phi_effective")),
          .phi_geometric = number(facts.at("phi_geometric")),
          .radius = number(facts.at("radius")),
          .phi_bulk = estimate_of(run.analysis, "phi_bulk").value,
          .viscosity = estimate_of(run.analysis, "relative_viscosity"),
          .velocity_variance = analysis::total_variance({estimate_of(run.analysis, "velocity_variance_x"), estimate_of(run.analysis, "velocity_variance_y"),
                                                         estimate_of(run.analysis, "velocity_variance_z")})};
}

Json law(const char* model, const statistics::Fit& fit) {
  Json json = {{"model", model}};
  json.update(fit_json(fit));
  return json;
}

/// Names of all estimates, in the order of the first run that has them.
std::vector<std::string> names_of(const SweepAnalysis& sweep) {
  std::vector<std::string> names;
  if (sweep.runs.empty()) return names;
  for (const auto& [name, value] : sweep.runs.front().analysis.at("estimates").items()) names.push_back(name);
  return names;
}

/// A part of an estimate; null where the run hasn't got it.
Json part_of(const AnalysedRun& run, const std::string& name, const char* part) {
  const Json& all = run.analysis.at("estimates");
  return all.contains(name) ? all.at(name).at(part) : Json();
}

std::string cell(const Json& value) { return value.is_number() ? fmt::format("{:.10g}", value.get<double>()) : value.is_boolean() ? (value.get<bool>() ? "1" : "0") : ""; }

void write_h5(const std::filesystem::path& path, const SweepAnalysis& sweep) {
  auto file = hdf5::File::create(path);
  file.set_attribute("/", "format", sweep_analysis_format);
  const auto column = [&](const std::string& name, const auto& value_of) {
    std::vector<double> values;
    for (const auto& run : sweep.runs) values.push_back(value_of(run));
    file.write<double>(name, values, {values.size()});
  };
  file.create_group("/runs");
  std::vector<std::string> directories;
  for (const auto& run : sweep.runs) directories.push_back(run.directory);
  file.write_strings("/runs/directory", directories);
  for (const char* name : run_numbers) column(std::string("/runs/") + name, [&](const AnalysedRun& run) { return number(run.analysis.at("run").at(name)); });
  for (const auto& name : names_of(sweep)) {
    const std::string group = "/estimates/" + name;
    file.create_group(group);
    for (const char* part : {"value", "error"}) column(group + "/" + part, [&](const AnalysedRun& run) { return number(part_of(run, name, part)); });
    std::vector<std::uint8_t> converged;
    for (const auto& run : sweep.runs) converged.push_back(part_of(run, name, "converged") == true ? 1 : 0);
    file.write<std::uint8_t>(group + "/converged", converged, {converged.size()});
    const Json& first = sweep.runs.front().analysis.at("estimates").at(name);
    for (const char* text : {"unit", "description"}) file.set_attribute(group, text, first.at(text).get<std::string>());
  }
  file.close();
}

}  // namespace

Json read_analysis(const std::filesystem::path& path) {
  std::ifstream file(path);
  Json json = Json::parse(file, nullptr, false);
  if (json.is_object() && json.contains("format") && json["format"] == analysis_format && json.contains("run") && json.contains("estimates") &&
      json.contains("settings") && json.contains("fits")) {
    return json;
  }
  throw InputError(fmt::format("{} is no result of corpuscle analyse", path.string()));
}

statistics::Estimate estimate_of(const Json& analysis, const std::string& name) {
  const Json& from = analysis.at("estimates").at(name);
  return {.value = number(from.at("value")), .error = number(from.at("error")), .correlation_time = number(from.at("correlation_time")),
          .effective_samples = number(from.at("effective_samples")), .converged = from.at("converged").get<bool>(), .reason = from.at("reason").get<std::string>()};
}

SweepAnalysis combine(std::vector<AnalysedRun> runs, std::vector<std::string> warnings) {
  SweepAnalysis sweep;
  sweep.warnings = std::move(warnings);
  std::vector<analysis::RunOutcome> outcomes;
  for (const auto& run : runs) {
    try {
      const auto outcome = outcome_of(run);
      if (run.fits) outcomes.push_back(outcome);
    } catch (const nlohmann::json::exception& error) {
      throw InputError(fmt::format("{}/analysis.json can't be used ({}): remove it, and the run is analysed anew", run.directory, error.what()));
    }
  }
  sweep.runs = std::move(runs);
  sweep.curves = analysis::flow_curves(outcomes);
  sweep.critical_volume_fraction = analysis::critical_volume_fraction(sweep.curves);
  sweep.gap_radius = analysis::gap_radius(outcomes);
  return sweep;
}

Json sweep_analysis_json(const SweepAnalysis& sweep) {
  Json json = {{"format", sweep_analysis_format}, {"version", version_string()}, {"git_revision", git_revision()}};
  json["runs"] = json["flow_curves"] = Json::array();
  for (const auto& run : sweep.runs) {
    Json estimates = Json::object();
    for (const auto& [name, e] : run.analysis.at("estimates").items()) estimates[name] = {{"value", e.at("value")}, {"error", e.at("error")}, {"converged", e.at("converged")}};
    json["runs"].push_back({{"directory", run.directory}, {"run", run.analysis.at("run")}, {"estimates", estimates}, {"fits", run.analysis.at("fits")}});
  }
  for (const auto& curve : sweep.curves) {
    json["flow_curves"].push_back({{"phi_effective", json_number(curve.phi_effective)},
                                   {"phi_geometric", json_number(curve.phi_geometric)},
                                   {"runs", curve.runs},
                                   {"shear_thinning", law("prefactor Ca^-exponent", curve.shear_thinning)},
                                   {"yield_stress", law("yield_stress/Ca + prefactor Ca^-exponent", curve.yield_stress)}});
  }
  const auto& critical = sweep.critical_volume_fraction;
  json["critical_volume_fraction"] = {{"value", json_number(critical.value)}, {"error", json_number(critical.error)}, {"converged", critical.converged}, {"reason", critical.reason},
                                      {"description", "effective volume fraction at which the yield stress of the fits vanishes"}};
  json["gap_radius"] = law("l = 2 slope (phi^(-1/3) - 1), l in lattice spacings", sweep.gap_radius);
  json["warnings"] = sweep.warnings;
  return json;
}

std::string sweep_analysis_csv(const SweepAnalysis& sweep) {
  const auto names = names_of(sweep);
  std::string text = "directory";
  for (const char* name : run_numbers) text += fmt::format(",{}", name);
  for (const auto& name : names) text += fmt::format(",{0},{0}_error,{0}_converged", name);
  for (const auto& run : sweep.runs) {
    text += "\n" + csv_field(run.directory);
    for (const char* name : run_numbers) text += "," + cell(run.analysis.at("run").at(name));
    for (const auto& name : names)
      for (const char* part : {"value", "error", "converged"}) text += "," + cell(part_of(run, name, part));
  }
  return text + "\n";
}

void write_sweep_analysis_h5(const std::filesystem::path& path, const SweepAnalysis& sweep) {
  auto temporary = path;
  temporary += ".tmp";
  try {
    write_h5(temporary, sweep);
  } catch (const OutputError&) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw;
  }
  std::error_code error;
  std::filesystem::rename(temporary, path, error);
  if (error) throw OutputError(fmt::format("{}: writing the analysis failed: {}", path.string(), error.message()));
}

std::string sweep_analysis_page(const SweepAnalysis& sweep) {
  const std::vector<std::pair<const char*, const char*>> columns{
      {"relative_viscosity", "viscosity"}, {"normal_stress_difference_1", "N1"},     {"phi_bulk", "phi bulk"},       {"velocity_variance_y", "variance y"},
      {"velocity_variance_z", "variance z"}, {"gap_size", "gap / r"},                {"diffusivity_msd_y", "D y"},   {"diffusivity_msd_z", "D z"},
      {"stress_fluctuation", "RMS stresslet"}, {"stress_relaxation_time", "stress time"}, {"deformation", "deformation"}};
  std::string page = "# Analysis of a sweep\n\nEach run has a page of its own, analysis.md in its directory. A star marks what is not converged.\n\n| run | Ca | phi |";
  for (const auto& column : columns) page += fmt::format(" {} |", column.second);
  page += "\n|---|---|---|";
  for (std::size_t i = 0; i < columns.size(); ++i) page += "---|";
  page += "\n";
  for (const auto& run : sweep.runs) {
    const Json& facts = run.analysis.at("run");
    page += fmt::format("| {} | {:.4g} | {:.4g} |", run.directory, number(facts.at("capillary_number")), number(facts.at("phi_effective")));
    for (const auto& [name, heading] : columns) {
      const double value = number(part_of(run, name, "value"));
      page += fmt::format(" {}{} |", with_error(value, number(part_of(run, name, "error"))), std::isnan(value) || part_of(run, name, "converged") == true ? "" : " *");
    }
    page += "\n";
  }
  page += "\n## Flow curves\n\nyield_stress in kappa_S/r.\n\n| phi | runs | prefactor Ca^-exponent | yield_stress/Ca + prefactor Ca^-exponent |\n|---|---|---|---|\n";
  const auto text_of = [](const statistics::Fit& fit) {
    std::string text;
    for (std::size_t i = 0; i < fit.names.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      text += fmt::format("{}{} = {}", i == 0 ? "" : ", ", fit.names[i], with_error(fit.parameters[k], fit.errors[k]));
    }
    if (!fit.converged) text += fmt::format("{}({})", text.empty() ? "" : " ", fit.reason);
    return text;
  };
  for (const auto& curve : sweep.curves)
    page += fmt::format("| {:.4g} | {} | {} | {} |\n", curve.phi_effective, curve.runs.size(), text_of(curve.shear_thinning), text_of(curve.yield_stress));
  const auto& critical = sweep.critical_volume_fraction;
  page += fmt::format("\nYield stress vanishes at phi = {}{}.\nGap between cells, l = 2 r' (phi^(-1/3) - 1) with r' in lattice spacings: {}.\n",
                      with_error(critical.value, critical.error), critical.converged ? "" : " (" + critical.reason + ")", text_of(sweep.gap_radius));
  return page + warnings_page(sweep.warnings);
}

}  // namespace corpuscle
