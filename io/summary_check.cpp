#include "io/summary_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

namespace corpuscle {

bool check_summary(const std::filesystem::path& path, const RunFacts& run, bool running, const std::function<void(const std::string& file)>& reading,
                   OutputCheck& out) {
  const std::string name = "summary.json";
  const auto problem = [&](const std::string& file, const std::string& what, const std::string& advice) { out.problems.push_back({file, what, advice}); };
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    if (out.is_output && !running)
      problem(name, "is missing: the run did not end in order",
              out.resumes_at >= 0 ? fmt::format("corpuscle resume goes on at step {}", out.resumes_at)
              : out.samples > 0   ? fmt::format("what run.h5 holds, up to step {}, can be used", out.last_step)
                                  : "run it again");
    return false;
  }
  if (reading) reading(name);
  std::ifstream file(path);
  const auto json = nlohmann::json::parse(file, nullptr, false);
  if (!json.is_object()) {
    problem(name, "is not a JSON object", "its means can be computed again from run.h5");
    return true;
  }
  const auto number = [&](const char* key) { return json.contains(key) && json[key].is_number() ? json[key].get<double>() : std::nan(""); };
  const auto disagree = [&](const std::string& key, double here, double there) {
    problem(name, fmt::format("{} is {:.9g}, run.h5 says {:.9g}", key, here, there), "the files are of different runs, or one was changed");
  };
  const double steps = number("steps");
  const std::string stopped_by = json.contains("stopped_by") && json["stopped_by"].is_string() ? json["stopped_by"].get<std::string>() : "";
  if (std::isnan(steps) || stopped_by.empty()) problem(name, "lacks steps or stopped_by", "the file was changed or damaged");
  if (stopped_by != "end" && !stopped_by.empty()) out.notes.push_back(fmt::format("the run was stopped by: {}", stopped_by.substr(0, 100)));
  if (!run.readable || run.steps.empty()) return true;
  const auto last = static_cast<double>(run.steps.back());
  if (stopped_by == "end" ? last != steps : last > steps) disagree("steps", steps, last);
  double cells = 0;
  for (const auto count : run.type_counts) cells += static_cast<double>(count);
  if (number("cell_count") != cells) disagree("cell_count", number("cell_count"), cells);
  // Of a failed run the last samples may be missing in run.h5.
  if (stopped_by == "guard" || stopped_by == "output error") return true;
  const double from = number("averaged_from_strain"), mean = number("relative_viscosity");
  double sum = 0, samples = 0;
  for (std::size_t i = 0; i < std::min(run.strain.size(), run.relative_viscosity.size()); ++i)
    if (run.strain[i] >= from - 1e-12) sum += run.relative_viscosity[i], ++samples;
  if (std::isfinite(mean) && std::isfinite(from) && samples > 0 && !(std::abs(sum / samples - mean) <= 1e-9 * std::abs(mean)))
      disagree("relative_viscosity", mean, sum / samples);
  if (const double drift = number("volume_drift_max"); std::isfinite(drift) && !run.volume_drift_max.empty()) {
    const double largest = *std::max_element(run.volume_drift_max.begin(), run.volume_drift_max.end());
    if (!(std::abs(largest - drift) <= 1e-9 * std::abs(largest) + 1e-15)) disagree("volume_drift_max", drift, largest);
  }
  return true;
}

}  // namespace corpuscle
