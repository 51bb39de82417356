// The readable side of io/analysis_file.hpp.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/analysis_file.hpp"

namespace corpuscle {
namespace {

using analysis::Analysis;
using analysis::RunRecord;

std::string number(double value, const char* format = "{:.4g}") { return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "-"; }

/// Reasons, each with all the names that it is given for.
class Reasons {
 public:
  void add(const std::string& name, const std::string& reason) {
    const auto found = std::find_if(list_.begin(), list_.end(), [&](const auto& item) { return item.first == reason; });
    if (found == list_.end()) list_.emplace_back(reason, name);
    else found->second += ", " + name;
  }
  std::string page() const {
    std::string text;
    for (const auto& [reason, names] : list_) text += fmt::format("- {}: {}\n", names, reason);
    return text.empty() ? text : "\n## Not to be trusted, or not there\n\n" + text;
  }

 private:
  std::vector<std::pair<std::string, std::string>> list_;
};

std::string estimates_page(const Analysis& analysis, Reasons& reasons) {
  std::string page = "\n| | value | unit | correlation time | independent samples | converged |\n|---|---|---|---|---|---|\n";
  for (const auto& item : analysis.estimates) {
    const auto& e = item.estimate;
    if (!e.converged) reasons.add(item.name, e.reason);
    if (std::isnan(e.value)) continue;
    page += fmt::format("| {} | {} | {} | {} | {} | {} |\n", item.name, with_error(e.value, e.error), item.unit == "1" ? "" : item.unit, number(e.correlation_time, "{:.3g}"),
                        number(e.effective_samples, "{:.0f}"), e.converged ? "yes" : "**no**");
  }
  return page;
}

std::string fits_page(const Analysis& analysis, Reasons& reasons) {
  std::string page;
  for (const auto& item : analysis.fits) {
    if (!item.fit.converged) reasons.add(item.name, item.fit.reason);
    std::string parameters;
    for (std::size_t i = 0; i < item.fit.names.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      if (std::isnan(item.fit.parameters[k])) continue;
      parameters += fmt::format("{}{} = {}", parameters.empty() ? "" : ", ", item.fit.names[i], with_error(item.fit.parameters[k], item.fit.errors[k]));
    }
    if (!parameters.empty()) page += fmt::format("| {} | {} | {} | {} |\n", item.name, item.model, parameters, item.fit.converged ? "yes" : "**no**");
  }
  return page.empty() ? page : "\n## Fits\n\n| | model | parameters | converged |\n|---|---|---|---|\n" + page;
}

}  // namespace

std::string with_error(double value, double error) {
  if (!std::isfinite(value)) return "-";
  if (!std::isfinite(error) || error <= 0) return fmt::format("{:.6g}", value);
  const int place = static_cast<int>(std::floor(std::log10(error))) - 1;  // of the error's second digit
  const double size = std::max(std::abs(value), error);
  if (size >= 1e6 || size < 1e-4) {
    const int exponent = static_cast<int>(std::floor(std::log10(size)));
    const int digits = std::clamp(exponent - place, 0, 15);
    return fmt::format("({:.{}f} ± {:.{}f})e{}", value / std::pow(10, exponent), digits, error / std::pow(10, exponent), digits, exponent);
  }
  const int digits = std::clamp(-place, 0, 15);
  return fmt::format("{:.{}f} ± {:.{}f}", value, digits, error, digits);
}

std::string warnings_page(const std::vector<std::string>& warnings) {
  std::string page;
  for (const auto& text : warnings) page += fmt::format("- {}\n", text);
  return page.empty() ? page : "\n## Warnings\n\n" + page;
}

std::string analysis_page(const RunRecord& record, const Analysis& analysis) {
  const auto& settings = analysis.settings;
  std::string page = fmt::format("# Analysis of {}\n\n", record.directory);
  page += fmt::format("Ca = {}, phi = {} (effective {}), {} cells of radius {} (effective {}), box {:g} x {:g} x {:g}; {} samples up to strain {}, {} apart.\n\n",
                      number(record.capillary_number), number(record.phi_geometric), number(record.phi_effective), record.cell_count(), number(record.radius),
                      number(record.mean_effective_radius()), record.box[0], record.box[1], record.box[2], record.samples, number(record.strain), number(record.interval));
  page += fmt::format("The first {} strains are left out{}. Layers of {:g} radii at the walls are left out; mean flow: {}; lags up to {} strains.\n",
                      number(settings.discarded_strain), analysis.start_up.converged ? "" : " (**not converged**)", settings.wall_layer,
                      settings.mean_flow == analysis::MeanFlow::uniform ? "uniform" : "measured", number(settings.longest_lag));
  if (record.rate_factor != 1) page += fmt::format("Ca, strains and all rates are referred to the shear rate of the bulk, {} of that of the walls.\n", number(record.rate_factor));
  page += "Times in strains, lengths in radii r, velocities in gamma_dot r, stresses in eta_0 gamma_dot.\n";
  Reasons reasons;
  page += estimates_page(analysis, reasons);
  page += fits_page(analysis, reasons);
  page += reasons.page();
  page += warnings_page(analysis.warnings);
  return page;
}

}  // namespace corpuscle
