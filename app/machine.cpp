#include "app/machine.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <sys/resource.h>
#include <sys/utsname.h>

#include <Kokkos_Core.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

#include "app/commands.hpp"

namespace corpuscle::app {
namespace {

/// Value behind the first line of a file that starts with `key`.
std::string value_in(const char* path, const std::string& key, char separator) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);)
    if (line.rfind(key, 0) == 0) {
      const auto at = line.find(separator);
      if (at == std::string::npos) continue;
      const auto begin = line.find_first_not_of(" \t\"", at + 1);
      const auto end = line.find_last_not_of(" \t\"");
      if (begin != std::string::npos) return line.substr(begin, end - begin + 1);
    }
  return "unknown";
}

/// "  1234 kB" in bytes; 0 for anything else.
std::int64_t kilobytes(const std::string& text) { return 1024 * std::strtoll(text.c_str(), nullptr, 10); }

/// Limit of the control group that this process is in, as batch systems and containers set it; 0: none.
std::int64_t group_limit() {
  std::string path;
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);)
    if (line.starts_with("0::")) path = line.substr(3);
  for (const std::string& group : {"/sys/fs/cgroup" + path, std::string("/sys/fs/cgroup")}) {
    std::int64_t limit = 0;
    if (std::ifstream(group + "/memory.max") >> limit) return limit;  // the word "max" means none
  }
  return 0;
}

std::int64_t memory_in(const char* line) {
  const std::int64_t machine = kilobytes(value_in("/proc/meminfo", line, ':')), group = group_limit();
  return group > 0 && machine > 0 ? std::min(machine, group) : machine;
}

}  // namespace

std::int64_t total_memory_bytes() { return memory_in("MemTotal"); }
std::int64_t available_memory_bytes() { return memory_in("MemAvailable"); }

std::string cpu_model() { return value_in("/proc/cpuinfo", "model name", ':'); }
std::int64_t cpu_cores() { return std::thread::hardware_concurrency(); }
std::string operating_system() {
  utsname name{};
  uname(&name);
  return value_in("/etc/os-release", "PRETTY_NAME", '=') + ", " + name.sysname + " " + name.release;
}
std::string kokkos_configuration() {
  std::ostringstream text;
  Kokkos::print_configuration(text);
  return text.str();
}
std::int64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t(usage.ru_maxrss) * 1024;
}

void return_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
#endif
}

void print_warnings(const std::vector<std::string>& warnings) {
  for (const auto& warning : warnings) std::fprintf(stderr, "warning: %s\n", warning.c_str());
}

KokkosSession::KokkosSession(int threads) {
  Kokkos::InitializationSettings settings;
  if (threads > 0) settings.set_num_threads(threads);
  settings.set_disable_warnings(true);  // advice on thread binding belongs into docs, not between the lines of a run
  Kokkos::initialize(settings);
}
KokkosSession::~KokkosSession() { Kokkos::finalize(); }

}  // namespace corpuscle::app
