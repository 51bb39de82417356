// Runs as child processes of this program, each with a log of its own.
#pragma once
#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace corpuscle::app {

/// How to start one.
struct ChildCommand {
  std::vector<std::string> arguments;  ///< of corpuscle, without its name
  std::filesystem::path log;           ///< stdout and stderr go there, behind what it holds
  int threads = 1;
  bool alone = true;  ///< no other run beside it: threads may be bound to cores, and spin while they wait
};

/// How one ended.
struct ChildEnd {
  std::size_t run = 0;
  int code = 0;         ///< exit code; 128 + signal when it was killed
  std::string message;  ///< the last "error: " of its log, or what killed it
};

class ChildRuns {
 public:
  ChildRuns() = default;
  ChildRuns(const ChildRuns&) = delete;
  ChildRuns& operator=(const ChildRuns&) = delete;
  /// Asks those that are left to stop with a checkpoint, and waits for them.
  ~ChildRuns();

  /// `run`: a number that the caller knows it by. A child hears of the end of this process, however that comes, as SIGTERM. @throws OutputError
  void start(std::size_t run, const ChildCommand& command);
  /// Those that have ended since.
  std::vector<ChildEnd> ended();
  /// Hands a signal to all.
  void signal(int number) const;
  std::vector<std::size_t> running() const;

 private:
  struct Child {
    std::size_t run;
    pid_t process;
    std::filesystem::path log;
    std::uintmax_t log_begin;  ///< what was in it before
  };
  std::vector<Child> children_;
};

/// The last line of a log that begins with "error: ", without that; empty when there is none. Looks from `begin` on, at the last 64 KiB.
std::string last_error(const std::filesystem::path& log, std::uintmax_t begin = 0);

}  // namespace corpuscle::app
