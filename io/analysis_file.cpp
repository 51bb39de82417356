#include "io/analysis_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/version.hpp"

namespace corpuscle {
namespace {

using Json = nlohmann::ordered_json;


Json numbers(const Eigen::VectorXd& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(json_number(value));
  return list;
}

Json rows(const Eigen::Matrix3d& matrix) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < 3; ++i) list.push_back(numbers(matrix.row(i)));
  return list;
}

Json trust(bool converged, const std::string& reason) { return {{"converged", converged}, {"reason", reason}}; }

Json estimate_json(const analysis::NamedEstimate& item) {
  const auto& e = item.estimate;
  return {{"value", json_number(e.value)}, {"error", json_number(e.error)}, {"unit", item.unit}, {"correlation_time", json_number(e.correlation_time)},
          {"effective_samples", json_number(e.effective_samples)}, {"converged", e.converged}, {"reason", e.reason}, {"description", item.description}};
}

Json curve_json(const analysis::NamedCurve& item) {
  const auto& c = item.curve;
  Json json = {{"x", numbers(c.x)}, {"value", numbers(c.value)}, {"error", numbers(c.error)}, {"x_unit", item.x_unit}, {"unit", item.unit},
               {"x_label", item.x_label}, {"label", item.label}, {"trusted_until", json_number(c.trusted_until)}};
  json.update(trust(c.converged, c.reason));
  json["description"] = item.description;
  return json;
}

const char* name_of(analysis::MeanFlow flow) { return flow == analysis::MeanFlow::uniform ? "uniform" : "measured"; }

}  // namespace

Json json_number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

Json fit_json(const statistics::Fit& fit) {
  Json parameters = Json::object();
  for (std::size_t i = 0; i < fit.names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    parameters[fit.names[i]] = {{"value", json_number(fit.parameters[k])}, {"error", json_number(fit.errors[k])}};
  }
  Json json = {{"parameters", parameters}, {"chi2", json_number(fit.chi2)}, {"degrees_of_freedom", fit.degrees_of_freedom}, {"probability", json_number(fit.probability)}};
  json.update(trust(fit.converged, fit.reason));
  return json;
}

Json asked_json(const analysis::AnalysisOptions& options) {
  return {{"wall_layer", options.wall_layer}, {"mean_flow", name_of(options.mean_flow)}, {"shear_rate", options.rate == analysis::RateOf::bulk ? "bulk" : "walls"},
          {"discard", json_number(options.discard)}, {"longest_lag", json_number(options.longest_lag)}};
}

Json analysis_json(const analysis::RunRecord& record, const analysis::Analysis& analysis) {
  const auto& settings = analysis.settings;
  Json json;
  json["format"] = analysis_format;
  json["version"] = version_string();
  json["git_revision"] = git_revision();
  json["run"] = {{"directory", record.directory},
                 {"capillary_number", json_number(record.capillary_number)},
                 {"phi_geometric", json_number(record.phi_geometric)},
                 {"phi_effective", json_number(record.phi_effective)},
                 {"cell_count", record.cell_count()},
                 {"radius", json_number(record.radius)},
                 {"effective_radius", json_number(record.mean_effective_radius())},
                 {"viscosity", json_number(record.viscosity)},
                 {"shear_rate", json_number(record.shear_rate)},
                 {"rate_factor", json_number(record.rate_factor)},
                 {"box", record.box},
                 {"strain", json_number(record.strain)},
                 {"samples", record.samples},
                 {"sample_interval", json_number(record.interval)}};
  json["settings"] = {{"wall_layer", settings.wall_layer},
                      {"mean_flow", name_of(settings.mean_flow)},
                      {"discarded_strain", json_number(settings.discarded_strain)},
                      {"longest_lag", json_number(settings.longest_lag)},
                      {"contact_distance", json_number(settings.contact_distance)},
                      {"contact_distance_from", settings.contact_distance_from},
                      {"asked", asked_json(settings.asked)}};
  json["equilibration"] = {{"strain", json_number(analysis.start_up_strain)}};
  json["equilibration"].update(trust(analysis.start_up.converged, analysis.start_up.reason));
  json["estimates"] = json["curves"] = json["fits"] = json["tensors"] = Json::object();
  for (const auto& item : analysis.estimates) json["estimates"][item.name] = estimate_json(item);
  for (const auto& item : analysis.curves) json["curves"][item.name] = curve_json(item);
  for (const auto& item : analysis.fits) {
    Json fit = {{"model", item.model}};
    fit.update(fit_json(item.fit));
    fit["curve"] = item.curve;
    fit["from"] = json_number(item.from);
    fit["to"] = json_number(item.to);
    json["fits"][item.name] = fit;
  }
  for (const auto& item : analysis.tensors) {
    Json tensor = {{"value", rows(item.value)}, {"error", rows(item.error)}, {"unit", item.unit}};
    tensor.update(trust(item.converged, item.reason));
    tensor["description"] = item.description;
    json["tensors"][item.name] = tensor;
  }
  json["warnings"] = analysis.warnings;
  return json;
}

void require_replaceable(const std::filesystem::path& path, const std::string& format, const std::vector<std::string>& other_endings) {
  const auto refuse = [](const std::filesystem::path& lost) {
    throw InputError(fmt::format("{} is there and is no result of corpuscle analyse: it would be lost; remove it, or give another --output", lost.string()));
  };
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) {
    std::ifstream file(path);
    const auto json = nlohmann::json::parse(file, nullptr, false);
    if (!json.is_object() || !json.contains("format") || json["format"] != format) refuse(path);
    return;
  }
  for (const auto& ending : other_endings) {
    const auto other = std::filesystem::path(path).replace_extension(ending);
    if (std::filesystem::exists(other, ignored)) refuse(other);
  }
}

}  // namespace corpuscle
