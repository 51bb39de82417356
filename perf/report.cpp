#include "perf/report.hpp"

#include <Kokkos_Core.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <sstream>

#include "core/types.hpp"
#include "core/version.hpp"

namespace corpuscle::perf {

Section::Section(int argc, char** argv, std::string name, std::string about, std::vector<Metric> metrics)
    : name_(std::move(name)),
      about_(std::move(about)),
      metrics_(std::move(metrics)) {
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--quick") {
      effort_ = {true, 1, 0};
    } else if (argument == "--output" && i + 1 < argc) {
      output_ = argv[++i];
    } else {
      std::fprintf(stderr, "bench_%s: unknown argument %s\nusage: bench_%s [--quick] [--output FILE]\n", name_.c_str(), argv[i], name_.c_str());
      std::exit(2);
    }
  }
}

void Section::row(const std::string& name, const Json& values) {
  Json row = {{"case", name}};
  std::fprintf(stderr, "  %-46s", name.c_str());
  for (const auto& [key, value] : values.items()) {
    row[key] = value.is_number_float() ? Json(rounded(value.get<double>())) : value;
    for (const auto& metric : metrics_)
      if (metric.name == key) std::fprintf(stderr, " %s %s", key.c_str(), row[key].dump().c_str());
  }
  std::fprintf(stderr, "\n");
  rows_.push_back(row);
}

int Section::finish() {
  Json better = Json::object();
  for (const auto& metric : metrics_) better[metric.name] = metric.better;
  const Json section = {{"section", name_}, {"about", about_}, {"notes", notes_}, {"quick", effort_.quick}, {"build", build_description()},
                        {"better", better}, {"rows", rows_}};
  if (output_.empty()) {
    std::cout << section.dump(1) << std::endl;
    return 0;
  }
  std::ofstream file(output_);
  file << section.dump(1) << '\n';
  file.close();
  if (file) return 0;
  std::fprintf(stderr, "bench_%s: %s can't be written\n", name_.c_str(), output_.c_str());
  return 1;
}

Json build_description() {
  std::ostringstream configuration;
  Kokkos::print_configuration(configuration);
  return {{"compiler", CORPUSCLE_COMPILER},
          {"flags", CORPUSCLE_FLAGS},
          {"version", version_string()},
          {"revision", git_revision()},
          {"kokkos_version",
           std::to_string(KOKKOS_VERSION / 10000) + "." + std::to_string(KOKKOS_VERSION / 100 % 100) + "." + std::to_string(KOKKOS_VERSION % 100)},
          {"backend", ExecSpace::name()},
          {"threads", ExecSpace().concurrency()},
          {"kokkos_configuration", configuration.str()}};
}

double available_bytes() {
  std::ifstream file("/proc/meminfo");
  std::string key;
  for (double kibibytes; file >> key >> kibibytes; file.ignore(1000, '\n'))
    if (key == "MemAvailable:") return kibibytes * 1024;
  return 0;
}

double rounded(double x) {
  if (x == 0 || !std::isfinite(x)) return x;
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", x);
  return std::atof(text);
}

}  // namespace corpuscle::perf
