#include "app/machine.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <sys/resource.h>
#include <sys/utsname.h>

#include <Kokkos_Core.hpp>
#include <cstdio>
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

}  // namespace

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
