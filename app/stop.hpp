// Reasons to end a run before its end: signals, and the wall time that it may take.
#pragma once
#include <chrono>
#include <string>

namespace corpuscle::app {

enum class Stop { none, interrupt, user_signal, wall_time };

/// SIGINT and SIGTERM ask for `interrupt`, SIGUSR1 for `user_signal`. The running step is finished.
void listen_to_signals();
/// The first signal that came.
Stop signal_received();

/// The wall time of a process, counted from its start.
class WallTime {
 public:
  /// @param limit in seconds; 0: none
  explicit WallTime(double limit) : limit_(limit) {}
  /// Whether it is time to end, with this much left to do afterwards.
  bool over(double seconds_to_finish) const { return left() <= seconds_to_finish; }
  /// Seconds; infinity without a limit.
  double left() const;

 private:
  double limit_;
};

/// "[DAYS-]HH:MM:SS" in seconds. @throws InputError
double parse_wall_time(const std::string& text);

/// What summary.json and the last line call it.
const char* name_of(Stop stop);
/// Exit code of a run that was stopped so (core/error.hpp).
int exit_code_of(Stop stop);

}  // namespace corpuscle::app
