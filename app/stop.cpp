#include "app/stop.hpp"

#include <fmt/format.h>

#include <atomic>
#include <csignal>
#include <limits>
#include <regex>

#include "core/error.hpp"

namespace corpuscle::app {
namespace {

using Clock = std::chrono::steady_clock;
const Clock::time_point process_start = Clock::now();

std::atomic<Stop> received{Stop::none};
static_assert(std::atomic<Stop>::is_always_lock_free, "signal handlers may touch lock-free atomics only");

extern "C" void on_signal(int signal) {
  auto none = Stop::none;
  received.compare_exchange_strong(none, signal == SIGUSR1 ? Stop::user_signal : Stop::interrupt);
}

}  // namespace

void listen_to_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) std::signal(signal, on_signal);
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on the size of files is an error of the write, not the end of the process
}

Stop signal_received() { return received; }

double WallTime::left() const {
  if (!(limit_ > 0)) return std::numeric_limits<double>::infinity();
  return limit_ - std::chrono::duration<double>(Clock::now() - process_start).count();
}

double parse_wall_time(const std::string& text) {
  static const std::regex form("(?:([0-9]{1,4})-)?([0-9]{1,6}):([0-5][0-9]):([0-5][0-9])");
  std::smatch part;
  if (!std::regex_match(text, part, form))
    throw InputError(fmt::format("--wall-time {} must be HH:MM:SS or DAYS-HH:MM:SS, for example 11:50:00", text));
  const double days = part[1].matched ? std::stod(part[1]) : 0;
  const double seconds = 86400 * days + 3600 * std::stod(part[2]) + 60 * std::stod(part[3]) + std::stod(part[4]);
  if (!(seconds > 0)) throw InputError(fmt::format("--wall-time {} must be more than nothing", text));
  return seconds;
}

const char* name_of(Stop stop) {
  switch (stop) {
    case Stop::interrupt: return "interrupt";
    case Stop::user_signal: return "user signal";
    case Stop::wall_time: return "wall time";
    case Stop::none: break;
  }
  return "end";
}

int exit_code_of(Stop stop) {
  if (stop == Stop::none) return exit_code::success;
  return stop == Stop::interrupt ? exit_code::interrupted : exit_code::to_be_continued;
}

}  // namespace corpuscle::app
