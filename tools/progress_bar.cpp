#include "tools/progress_bar.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace burin {
namespace {

constexpr double kQuietSeconds = 2;     // shorter work needs no bar
constexpr double kRedrawSeconds = 0.1;  // faster than this nobody reads
constexpr double kGuessFrom = 0.05;     // below this fraction the time left is noise
constexpr int kBarCharacters = 20;

double seconds_between(std::chrono::steady_clock::time_point from, std::chrono::steady_clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

}  // namespace

std::string progress_line(std::string_view stage, double fraction, double stage_elapsed_s) {
  const double done = std::isfinite(fraction) ? std::clamp(fraction, 0.0, 1.0) : 0.0;
  const int filled = static_cast<int>(std::lround(done * kBarCharacters));
  std::string line = fmt::format("[{}{}] {:3.0f} %  {}", std::string(filled, '#'),
                                 std::string(kBarCharacters - filled, '-'), 100 * done, stage);
  if (done >= kGuessFrom) {
    const auto left_s = static_cast<long>(std::ceil(stage_elapsed_s * (1 - done) / done));
    line += fmt::format(", {}:{:02} left", left_s / 60, left_s % 60);
  }
  return line;
}

ProgressBar::ProgressBar()
    : on_terminal_(isatty(STDERR_FILENO) == 1), work_start_(Clock::now()), stage_start_(work_start_) {}

ProgressBar::~ProgressBar() { clear(); }

Progress ProgressBar::progress() {
  return [this](std::string_view stage, double fraction) { show(stage, fraction); };
}

void ProgressBar::show(std::string_view stage, double fraction) {
  if (!on_terminal_) return;
  const auto now = Clock::now();
  // "designing: d0 12, d1 9": what stands after the colon may change while the stage goes on.
  if (const std::string_view name = stage.substr(0, stage.find(':')); name != stage_) {
    stage_ = name;
    stage_start_ = now;
  }
  if (seconds_between(work_start_, now) < kQuietSeconds) return;
  if (drawn_ && seconds_between(last_drawn_, now) < kRedrawSeconds) return;
  // \r and "erase to the end of the line": the line is redrawn in place.
  fmt::print(stderr, "\r{}\x1b[K", progress_line(stage, fraction, seconds_between(stage_start_, now)));
  std::fflush(stderr);
  drawn_ = true;
  last_drawn_ = now;
}

void ProgressBar::clear() {
  if (!drawn_) return;
  fmt::print(stderr, "\r\x1b[K");
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace burin
