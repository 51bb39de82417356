#include "io/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string_view>

namespace corpuscle {
namespace {

constexpr double redraw_seconds = 0.25;
constexpr double log_seconds = 30;
constexpr double log_fraction = 0.1;
constexpr double longest_silence = 600;
constexpr const char* to_line_start = "\r";
constexpr const char* clear_to_line_end = "\x1b[K";

int terminal_width() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return 80;
}

double steady_seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// Columns of a UTF-8 text in which every character is one column wide.
int columns(std::string_view text) {
  return static_cast<int>(std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

}  // namespace

bool stream_is_terminal(std::FILE* stream) {
  const char* term = std::getenv("TERM");
  return isatty(fileno(stream)) != 0 && term != nullptr && std::string_view(term) != "dumb";
}

bool locale_is_unicode() {
  constexpr std::array<std::string_view, 4> spellings{"UTF-8", "UTF8", "utf-8", "utf8"};
  // The environment, not setlocale's state: a program that never calls setlocale still writes to a UTF-8 terminal.
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    if (const char* value = std::getenv(name); value != nullptr && *value != '\0') {
      const std::string_view text = value;
      return std::any_of(spellings.begin(), spellings.end(), [&](auto spelling) { return text.find(spelling) != std::string_view::npos; });
    }
  }
  return false;
}

std::string format_duration(double seconds) {
  if (!(seconds >= 0)) return "?";
  const auto s = static_cast<std::int64_t>(std::llround(seconds));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  if (s < 86400) return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
  return fmt::format("{} d {} h", s / 86400, s / 3600 % 24);
}

Progress::Progress(std::ostream& out, ProgressOptions options) : out_(out), options_(std::move(options)) {
  if (!options_.clock) options_.clock = steady_seconds;
  if (!options_.width) options_.width = terminal_width;
  state_.step = options_.first_step;
  start_ = options_.clock();
  // A terminal shows the first update at once; a log starts counting its interval here.
  last_output_ = options_.terminal ? start_ - redraw_seconds : start_;
  last_fraction_ = fraction();
}

double Progress::fraction() const {
  if (options_.last_step <= 0) return 0;
  return std::clamp(static_cast<double>(state_.step) / static_cast<double>(options_.last_step), 0.0, 1.0);
}

double Progress::seconds_left() const {
  const auto done = static_cast<double>(state_.step - options_.first_step);
  if (done <= 0) return std::numeric_limits<double>::quiet_NaN();
  return (options_.clock() - start_) / done * static_cast<double>(std::max<std::int64_t>(options_.last_step - state_.step, 0));
}

std::string Progress::details(bool short_form) const {
  const char* viscosity = options_.unicode ? "η_r" : "eta_r";
  const char* plus_minus = options_.unicode ? "±" : "+-";
  std::string text = options_.last_strain > 0 ? fmt::format("strain {:.2f}/{:g}", state_.strain, options_.last_strain)
                                              : fmt::format("step {}/{}", state_.step, options_.last_step);
  if (std::isfinite(state_.relative_viscosity)) {
    text += fmt::format("  {} {:.3f}", viscosity, state_.relative_viscosity);
    if (std::isfinite(state_.relative_viscosity_error)) text += fmt::format(" {} {:.3f}", plus_minus, state_.relative_viscosity_error);
  }
  if (!short_form) {
    text += fmt::format("  {}V {:.2f} %", options_.unicode ? "Δ" : "d", 100 * state_.volume_drift_max);
    text += fmt::format("  {:.1f} MLUPS", state_.mlups);
  }
  const double left = seconds_left();
  if (state_.step >= options_.last_step) {
    text += "  in " + format_duration(options_.clock() - start_);
  } else if (std::isfinite(left)) {
    text += fmt::format("  {} left", format_duration(left));
  }
  return text;
}

std::string Progress::line(int width) const {
  // What doesn't fit is dropped in order of importance; the last column stays free, or some terminals wrap.
  const int room = width - 1;
  const std::string percent = fmt::format("{:3.0f} %", std::floor(100 * fraction()));
  std::string text = percent + "  " + details(false);
  if (columns(text) > room) text = percent + "  " + details(true);
  if (columns(text) > room) text = percent;
  const int bar_room = std::min(room - columns(text) - 2, 30);
  if (bar_room < 6) return text;
  const int filled = static_cast<int>(std::lround(fraction() * bar_room));
  std::string bar;
  for (int i = 0; i < bar_room; ++i) bar += i < filled ? (options_.unicode ? "━" : "#") : (options_.unicode ? "╌" : ".");
  return bar + "  " + text;
}

void Progress::draw() {
  out_ << to_line_start << line(options_.width()) << clear_to_line_end << std::flush;
  line_open_ = true;
}

void Progress::log() {
  out_ << fmt::format("{:3.0f} %  {}\n", std::floor(100 * fraction()), details(false)) << std::flush;
  last_fraction_ = fraction();
}

void Progress::update(const ProgressState& state) {
  state_ = state;
  const double since = options_.clock() - last_output_;
  if (options_.terminal) {
    if (since < redraw_seconds) return;
    draw();
  } else {
    const bool due = since >= log_seconds && fraction() >= last_fraction_ + log_fraction - 1e-9;
    if (!due && since < longest_silence) return;
    log();
  }
  last_output_ = options_.clock();
}

void Progress::message(const std::string& text) {
  if (line_open_) out_ << to_line_start << clear_to_line_end;
  out_ << text << '\n';
  if (line_open_) draw();
  out_.flush();
}

void Progress::finish(const std::string& reason) {
  if (options_.terminal) {
    draw();
    out_ << '\n';
    line_open_ = false;
  } else {
    log();
  }
  if (!reason.empty() && reason != "end") out_ << "stopped: " << reason << '\n';
  out_.flush();
}

}  // namespace corpuscle
