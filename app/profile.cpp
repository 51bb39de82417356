#include "app/profile.hpp"

#include <fmt/format.h>

#include <Kokkos_Core.hpp>
#include <algorithm>

namespace corpuscle::app {
namespace {

Profile* active = nullptr;  // the hooks are plain functions

double seconds_between(std::chrono::steady_clock::time_point from, std::chrono::steady_clock::time_point to) { return std::chrono::duration<double>(to - from).count(); }

}  // namespace

struct Profile::Saved {
  Kokkos::Tools::Experimental::EventSet hooks = Kokkos::Tools::Experimental::get_callbacks();
};

struct Profile::Hooks {
  static void kernel(const char* name, std::uint32_t, std::uint64_t* id) {
    *id = 0;
    active->begin(name);
  }
  static void end_kernel(std::uint64_t) { active->end(); }
  static void copy(Kokkos_Profiling_SpaceHandle, const char*, const void*, Kokkos_Profiling_SpaceHandle, const char*, const void*, std::uint64_t) { active->begin("deep_copy"); }
  static void region(const char* name) { active->begin(name); }
  static void end() { active->end(); }
};

Profile::Profile() : saved_(std::make_unique<Saved>()) {
  active = this;
  namespace hooks = Kokkos::Tools::Experimental;
  hooks::set_begin_parallel_for_callback(Hooks::kernel);
  hooks::set_begin_parallel_reduce_callback(Hooks::kernel);
  hooks::set_begin_parallel_scan_callback(Hooks::kernel);
  hooks::set_end_parallel_for_callback(Hooks::end_kernel);
  hooks::set_end_parallel_reduce_callback(Hooks::end_kernel);
  hooks::set_end_parallel_scan_callback(Hooks::end_kernel);
  hooks::set_begin_deep_copy_callback(Hooks::copy);
  hooks::set_end_deep_copy_callback(Hooks::end);
  hooks::set_push_region_callback(Hooks::region);
  hooks::set_pop_region_callback(Hooks::end);
}

Profile::~Profile() {
  Kokkos::Tools::Experimental::set_callbacks(saved_->hooks);
  active = nullptr;
}

void Profile::begin(const std::string& name) { open_.push_back({&parts_[name], Clock::now()}); }

void Profile::end() {
  if (open_.empty()) return;  // the end of what had begun before
  const Open done = open_.back();
  open_.pop_back();
  const double seconds = seconds_between(done.begin, Clock::now());
  ++done.part->calls;
  done.part->seconds += seconds - done.inside;
  if (!open_.empty()) open_.back().inside += seconds;
}

std::vector<OperatorTime> Profile::times() const {
  double rest = seconds_between(start_, Clock::now());
  std::vector<OperatorTime> times;
  for (const auto& [name, part] : parts_) {
    times.push_back({name, part.calls, part.seconds});
    rest -= part.seconds;
  }
  std::stable_sort(times.begin(), times.end(), [](const OperatorTime& a, const OperatorTime& b) { return a.seconds > b.seconds; });
  times.push_back({"(rest)", 1, std::max(0.0, rest)});
  return times;
}

std::string profile_table(const std::vector<OperatorTime>& times) {
  double total = 0;
  for (const auto& t : times) total += t.seconds;
  std::string text = fmt::format("{:<28}{:>10}{:>12}{:>9}{:>12}\n", "operator", "calls", "seconds", "share", "ms a call");
  for (const auto& t : times)
    text += fmt::format("{:<28}{:>10}{:>12.4f}{:>7.2f} %{:>12.4f}\n", t.name, t.calls, t.seconds, 100 * t.seconds / total, 1e3 * t.seconds / double(std::max<std::int64_t>(t.calls, 1)));
  return text + fmt::format("{:<28}{:>10}{:>12.4f}\n", "all", "", total);
}

}  // namespace corpuscle::app
