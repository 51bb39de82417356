// What Kokkos was asked to do between two points: kernels, allocations, copies, fences. For tests and perf/: shows what a step pays for.
#pragma once
#include <Kokkos_Core.hpp>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace corpuscle {

/// Listens to Kokkos' profiling hooks as long as it lives; one at a time, and the hooks must be free (no other tool loaded).
class KernelLog {
 public:
  struct Launch {
    std::string label;
    enum Kind { loop, reduction, scan } kind;
  };
  /// By label; views of the same label are added up. Without the scratch memory of Kokkos.
  using Bytes = std::map<std::string, std::int64_t>;

  KernelLog() {
    current() = this;
    namespace hooks = Kokkos::Tools::Experimental;
    before_ = hooks::get_callbacks();
    hooks::set_begin_parallel_for_callback([](const char* name, std::uint32_t, std::uint64_t* id) { launched(name, Launch::loop, id); });
    hooks::set_begin_parallel_reduce_callback([](const char* name, std::uint32_t, std::uint64_t* id) { launched(name, Launch::reduction, id); });
    hooks::set_begin_parallel_scan_callback([](const char* name, std::uint32_t, std::uint64_t* id) { launched(name, Launch::scan, id); });
    hooks::set_begin_fence_callback([](const char* name, std::uint32_t, std::uint64_t* id) {
      const std::string label = name;
      if (label.find("Profile Tool Fence") == std::string::npos) current()->fences_.push_back(label);  // Kokkos waits after every kernel because a tool listens
      *id = 0;
    });
    hooks::set_allocate_data_callback([](Kokkos::Tools::SpaceHandle, const char* name, const void*, std::uint64_t bytes) {
      if (of_kokkos(name)) return;
      current()->allocated_[name] += std::int64_t(bytes);
      current()->live_[name] += std::int64_t(bytes);
    });
    hooks::set_deallocate_data_callback([](Kokkos::Tools::SpaceHandle, const char* name, const void*, std::uint64_t bytes) {
      if (!of_kokkos(name)) current()->live_[name] -= std::int64_t(bytes);
    });
    using Space = Kokkos::Tools::SpaceHandle;
    hooks::set_begin_deep_copy_callback([](Space, const char* to, const void*, Space, const char* from, const void*, std::uint64_t) {
      current()->copies_.push_back(std::string(from) + " -> " + to);
    });
  }
  ~KernelLog() {
    Kokkos::Tools::Experimental::set_callbacks(before_);
    current() = nullptr;
  }
  KernelLog(const KernelLog&) = delete;
  KernelLog& operator=(const KernelLog&) = delete;

  /// Forgets what happened so far.
  void clear() {
    launches_.clear();
    fences_.clear();
    copies_.clear();
    allocated_.clear();
    live_.clear();
  }

  /// In the order of their launch.
  const std::vector<Launch>& launches() const { return launches_; }
  /// How often each label was launched.
  std::map<std::string, int> counts() const {
    std::map<std::string, int> counts;
    for (const auto& launch : launches_) ++counts[launch.label];
    return counts;
  }
  /// Times the host waited for a device: reductions into a number, copies, explicit fences. The host backend reports the same waits.
  const std::vector<std::string>& fences() const { return fences_; }
  const std::vector<std::string>& copies() const { return copies_; }
  /// Everything allocated, whether freed since or not.
  const Bytes& allocated() const { return allocated_; }
  /// Allocated and not freed; without the labels that are back at zero.
  Bytes live() const {
    Bytes live;
    for (const auto& [label, bytes] : live_)
      if (bytes != 0) live[label] = bytes;
    return live;
  }
  static std::int64_t total(const Bytes& bytes) {
    std::int64_t sum = 0;
    for (const auto& [label, size] : bytes) sum += size;
    return sum;
  }

 private:
  static KernelLog*& current() {
    static KernelLog* log = nullptr;
    return log;
  }
  /// Scratch memory that the backend makes once and keeps: for teams, for reductions.
  static bool of_kokkos(const std::string& label) { return label.rfind("Kokkos::", 0) == 0 || label == "[unlabeled]"; }
  static void launched(const char* name, Launch::Kind kind, std::uint64_t* id) {
    current()->launches_.push_back({name, kind});
    *id = 0;
  }

  Kokkos::Tools::Experimental::EventSet before_;
  std::vector<Launch> launches_;
  std::vector<std::string> fences_, copies_;
  Bytes allocated_, live_;
};

}  // namespace corpuscle
