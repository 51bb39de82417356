// Where the time of a run goes: the time of every kernel and of the marked parts of the host's work, through the profiling hooks of Kokkos (corpuscle run --profile).
#pragma once
#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "io/summary.hpp"

namespace corpuscle::app {

/// Measures from its construction on. Times are exclusive: what runs inside a region (Kokkos::Profiling::pushRegion) counts for itself, so that the parts add up to the whole. On
/// devices Kokkos waits for each kernel while a profile is taken, which the run without profile does not. One at a time.
class Profile {
 public:
  Profile();
  ~Profile();
  Profile(const Profile&) = delete;
  Profile& operator=(const Profile&) = delete;

  /// Time since the construction by operator, the largest first; the last entry is what lies outside of all of them.
  std::vector<OperatorTime> times() const;

 private:
  struct Hooks;
  using Clock = std::chrono::steady_clock;
  struct Part {
    std::int64_t calls = 0;
    double seconds = 0;
  };
  struct Open {
    Part* part;
    Clock::time_point begin;
    double inside = 0;  ///< seconds of the parts that have run inside of this one
  };
  void begin(const std::string& name);
  void end();

  struct Saved;
  std::unique_ptr<Saved> saved_;  ///< hooks of a tool that was loaded before
  Clock::time_point start_ = Clock::now();
  std::map<std::string, Part> parts_;
  std::vector<Open> open_;
};

/// The table that `run --profile` prints: operator, calls, seconds, share, milliseconds a call.
std::string profile_table(const std::vector<OperatorTime>& times);

}  // namespace corpuscle::app
