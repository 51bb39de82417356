// What goes wrong in front of a user: every message names the key or object, the value, what is allowed and what to do.
#pragma once
#include <stdexcept>
#include <string>

namespace corpuscle {

/// Process exit codes, documented in docs/guide.md.
namespace exit_code {
inline constexpr int success = 0;
inline constexpr int failure = 1;        ///< Unexpected error (a bug, or the system failed us).
inline constexpr int bad_input = 2;      ///< The scene, a file or an option is wrong; nothing was written.
inline constexpr int broken_run = 3;     ///< A guard stopped the run (NaN, velocity limit, collapsed cell ...).
inline constexpr int to_be_continued = 75;  ///< Stopped by --wall-time or SIGUSR1 with a checkpoint: `corpuscle resume` goes on (EX_TEMPFAIL of sysexits.h).
inline constexpr int interrupted = 130;  ///< Stopped by Ctrl-C or SIGTERM with a checkpoint; all data up to then is kept.
}  // namespace exit_code

/// The user's input can't be used: a sentence that names key, value, allowed range and the way out. Exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A guard found that the running simulation is no longer physical. Exit code 3.
class SimulationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Writing or reading an output failed (disk full, permissions ...); what was flushed before is kept. Exit code 1.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace corpuscle
