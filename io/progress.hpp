// Tells on the console how a run goes: one line redrawn on a terminal, plain log lines in a pipe or file.
#pragma once
#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <ostream>
#include <string>

namespace corpuscle {

/// What the line shows.
struct ProgressState {
  std::int64_t step = 0;
  double strain = 0;
  double relative_viscosity = std::numeric_limits<double>::quiet_NaN();        ///< mean so far; NaN: not shown
  double relative_viscosity_error = std::numeric_limits<double>::quiet_NaN();  ///< NaN: shown without error
  double volume_drift_max = 0;                                                 ///< fraction
  double mlups = 0;                                                            ///< million lattice node updates per second
};

struct ProgressOptions {
  bool terminal = false;          ///< redraw one line (see stream_is_terminal)
  bool unicode = true;            ///< bar of line drawing characters; false: ASCII
  std::int64_t first_step = 0;    ///< where this process starts (not 0 after a resume): the rate counts from here
  std::int64_t last_step = 0;     ///< where the run ends
  double last_strain = 0;         ///< strain at the end; 0 at rest: steps are shown instead
  std::function<int()> width;     ///< columns of the terminal, asked at every redraw; default: the system's answer
  std::function<double()> clock;  ///< seconds, monotonic; default: the system's
};

/// Whether a stream is a terminal that understands "return to line start".
bool stream_is_terminal(std::FILE* stream);
/// Whether the locale's character set is UTF-8.
bool locale_is_unicode();

/// Call update() as often as convenient: it redraws at most four times a second, and logs only when a tenth more of the run and 30 s have
/// passed since the last line (or 10 minutes, so that a long run is never silent for longer). No escape codes when not on a terminal.
class Progress {
 public:
  Progress(std::ostream& out, ProgressOptions options);
  void update(const ProgressState& state);
  /// Prints a message on a line of its own without disturbing the bar.
  void message(const std::string& text);
  /// Shows the last state once more and ends the line. `reason` ("end", "interrupted" ...) is shown unless empty or "end".
  void finish(const std::string& reason = "end");

 private:
  double fraction() const;
  double seconds_left() const;  ///< NaN while unknown
  std::string line(int width) const;
  std::string details(bool short_form) const;
  void draw();
  void log();

  std::ostream& out_;
  ProgressOptions options_;
  ProgressState state_;
  double start_;
  double last_output_;
  double last_fraction_ = 0;
  bool line_open_ = false;
};

/// "4 s", "3 min 20 s", "2 h 05 min", "3 d 4 h".
std::string format_duration(double seconds);

}  // namespace corpuscle
