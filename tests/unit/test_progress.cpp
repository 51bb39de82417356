// The progress line on a terminal and in a pipe, with a clock that the test turns.
#include "io/progress.hpp"

#include <sstream>

#include "tests/catch.hpp"
#include "tests/contains.hpp"

using namespace corpuscle;

namespace {

struct Console {
  std::ostringstream out;
  double seconds = 0;
  int width = 100;
  ProgressOptions options(bool terminal) {
    return {.terminal = terminal, .unicode = true, .first_step = 0, .last_step = 1000, .last_strain = 10,
            .width = [this] { return width; }, .clock = [this] { return seconds; }};
  }
  std::size_t count(const std::string& what) const {
    std::size_t n = 0;
    const std::string text = out.str();
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
    return n;
  }
};

ProgressState at(std::int64_t step) { return {step, 0.01 * static_cast<double>(step), 1.543, 0.021, 0.0012, 15.4}; }

}  // namespace

TEST_CASE("progress: one redrawn line on a terminal, at most four times a second", "[io]") {
  Console console;
  Progress progress(console.out, console.options(true));
  for (int i = 1; i <= 100; ++i) {
    console.seconds = 0.01 * i;
    progress.update(at(5 * i));
  }
  CHECK(console.count("\r") <= 5);
  CHECK(console.count("\r") >= 4);
  CHECK(console.count("\n") == 0);
  progress.finish();
  const std::string text = console.out.str();
  CHECK(text.back() == '\n');
  CHECK_THAT(text, Contains(" 50 %") && Contains("strain 5.00/10") && Contains("η_r 1.543 ± 0.021") && Contains("ΔV 0.12 %") &&
                       Contains("15.4 MLUPS") && Contains("1 s left") && Contains("━"));
}

TEST_CASE("progress: the line fits the terminal", "[io]") {
  for (const int width : {200, 100, 80, 60, 40, 20}) {
    Console console;
    console.width = width;
    Progress progress(console.out, console.options(true));
    console.seconds = 100;
    progress.update(at(500));
    const std::string text = console.out.str();
    int columns = 0;
    for (const char c : text.substr(1, text.size() - 4)) columns += (static_cast<unsigned char>(c) & 0xC0) != 0x80 ? 1 : 0;
    CAPTURE(text);
    CHECK(columns < width);
    CHECK_THAT(text, Contains(" 50 %"));
  }
}

TEST_CASE("progress: plain lines in a pipe, after a tenth and 30 s", "[io]") {
  Console console;
  Progress progress(console.out, console.options(false));
  for (int step = 1; step <= 1000; ++step) {
    console.seconds = 0.1 * step;  // a run of 100 s: 30 s count
    progress.update(at(step));
  }
  CHECK(console.count("\n") == 3);
  CHECK(console.count("\r") == 0);
  CHECK(console.count("\x1b") == 0);
  progress.finish("interrupted");
  CHECK(console.count("\n") == 5);
  CHECK_THAT(console.out.str(), Contains(" 30 %  strain 3.00/10") && Contains("stopped: interrupted"));

  Console slow;
  Progress slow_progress(slow.out, slow.options(false));
  for (int step = 1; step <= 1000; ++step) {
    slow.seconds = 1.0 * step;  // 1000 s: every tenth
    slow_progress.update(at(step));
  }
  CHECK(slow.count("\n") == 10);

  Console very_slow;
  Progress very_slow_progress(very_slow.out, very_slow.options(false));
  for (int step = 1; step <= 10; ++step) {
    very_slow.seconds = 300.0 * step;  // 1 % in 50 min: no silence beyond ten minutes
    very_slow_progress.update(at(step));
  }
  CHECK(very_slow.count("\n") == 5);
}

TEST_CASE("progress: messages don't disturb the bar; ASCII and rest", "[io]") {
  Console console;
  auto options = console.options(true);
  options.unicode = false;
  options.last_strain = 0;
  Progress progress(console.out, options);
  console.seconds = 1;
  ProgressState state{.step = 250};
  progress.update(state);
  progress.message("checkpoint written");
  progress.finish();
  const std::string text = console.out.str();
  CHECK_THAT(text, Contains("\r\x1b[Kcheckpoint written\n\r") && Contains("step 250/1000") && Contains("###"));
  CHECK_THAT(text, !Contains("eta_r"));
}

TEST_CASE("progress: a resumed run's time left counts from where it resumed", "[io]") {
  Console console;
  auto options = console.options(true);
  options.first_step = 800;
  Progress progress(console.out, options);
  console.seconds = 100;
  progress.update(at(900));  // 100 steps in 100 s, 100 to go
  CHECK_THAT(console.out.str(), Contains("1 min 40 s left"));
}

TEST_CASE("progress: durations", "[io]") {
  CHECK(format_duration(4.4) == "4 s");
  CHECK(format_duration(200) == "3 min 20 s");
  CHECK(format_duration(7500) == "2 h 05 min");
  CHECK(format_duration(90000 * 3.0) == "3 d 3 h");
  CHECK(format_duration(std::numeric_limits<double>::quiet_NaN()) == "?");
}
