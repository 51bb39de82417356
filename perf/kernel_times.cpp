#include "perf/kernel_times.hpp"

#include <Kokkos_Core.hpp>
#include <algorithm>
#include <cstdio>
#include <vector>

namespace corpuscle::perf {
namespace {

namespace hooks = Kokkos::Tools::Experimental;

std::map<std::string, double> seconds_of;
std::string running;
Kokkos::Timer timer;

void begin(const char* name, std::uint32_t, std::uint64_t* id) {
  *id = 0;
  running = name;
  timer.reset();
}
void end(std::uint64_t) { seconds_of[running] += timer.seconds(); }

void listen(bool on) {
  hooks::set_begin_parallel_for_callback(on ? begin : nullptr);
  hooks::set_begin_parallel_reduce_callback(on ? begin : nullptr);
  hooks::set_begin_parallel_scan_callback(on ? begin : nullptr);
  hooks::set_end_parallel_for_callback(on ? end : nullptr);
  hooks::set_end_parallel_reduce_callback(on ? end : nullptr);
  hooks::set_end_parallel_scan_callback(on ? end : nullptr);
}

}  // namespace

std::string operator_of(const std::string& label) {
  // By the beginning of the label.
  static const std::vector<std::pair<std::string, std::string>> table{
      {"membrane", "membrane"},       {"contact", "contact"}, {"bin_", "contact"}, {"spread", "spread"},      {"sort_", "spread"},
      {"collide", "collide"},         {"exchange", "halo"},   {"bounce", "halo"},  {"scatter_force", "halo"}, {"gather_velocity", "halo"},
      {"interpolate", "interpolate"}, {"advance", "motion"}};
  for (const auto& [beginning, name] : table)
    if (label.rfind(beginning, 0) == 0) return name;
  if (label.rfind("Kokkos::", 0) != 0) std::fprintf(stderr, "warning: the kernel %s belongs to no operator, add it to perf/kernel_times.cpp\n", label.c_str());
  return "other";
}

StepTimes step_times(const std::function<void()>& step, int repeats, int steps) {
  step(), step();  // allocations, and both parities of streaming
  StepTimes best;
  best.step = 1e30;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    seconds_of.clear();
    listen(true);
    Kokkos::fence();
    const Kokkos::Timer whole;
    for (int i = 0; i < steps; ++i) step();
    Kokkos::fence();
    const double seconds = whole.seconds() / steps;
    listen(false);
    if (seconds >= best.step) continue;
    best = {seconds, {}};
    double inside = 0;
    for (const auto& name : operators) best.parts[name] = 0;
    for (const auto& [label, sum] : seconds_of) {
      best.parts[operator_of(label)] += sum / steps;
      inside += sum / steps;
    }
    best.parts["outside"] = std::max(0.0, seconds - inside);
  }
  return best;
}

void add_parts(Json& row, const StepTimes& times) {
  for (const auto& name : operators) row[name + "_ms"] = times.parts.at(name) * 1e3;
}

std::vector<Metric> part_metrics() {
  std::vector<Metric> metrics;
  for (const auto& name : operators)
    if (name != "other" && name != "outside") metrics.push_back({name + "_ms", "lower"});
  return metrics;
}

}  // namespace corpuscle::perf
