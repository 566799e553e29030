#include "tools/progress_bar.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <system_error>
#include <utility>

#include "tools/output_mode.h"
#include "tools/standard_streams.h"

namespace burin {
namespace {

constexpr double kQuietSeconds = 2;     // shorter work needs no bar
constexpr double kRedrawSeconds = 0.1;  // shorter intervals are unreadable
constexpr double kGuessFrom = 0.05;     // below this fraction the remaining time is noise
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
    : on_terminal_(is_for_people() && isatty(STDERR_FILENO) == 1),
      work_start_(Clock::now()),
      stage_start_(work_start_) {}

ProgressBar::~ProgressBar() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  changed_.notify_one();
  if (drawer_.joinable()) drawer_.join();
  clear();
}

Progress ProgressBar::progress() {
  return [this](std::string_view stage, double fraction) { show(stage, fraction); };
}

void ProgressBar::show(std::string_view stage, double fraction) {
  tell_progress(stage, fraction);
  if (!on_terminal_) return;
  const auto now = Clock::now();
  const std::lock_guard lock(mutex_);
  // "designing: d0 12, d1 9": the text behind the colon may change during a stage.
  if (const std::string_view name = stage.substr(0, stage.find(':')); name != stage_) {
    stage_ = name;
    stage_start_ = now;
  }
  said_ = stage;
  fraction_ = fraction;
  if (now >= due()) {
    draw();
    return;
  }
  if (!drawer_.joinable() && !has_no_thread_) try {
      drawer_ = std::thread([this] { draw_when_due(); });
    } catch (const std::system_error&) {  // no thread: the next report draws the line
      has_no_thread_ = true;
    }
  if (!std::exchange(waiting_, true)) changed_.notify_one();
}

void ProgressBar::clear() {
  const std::lock_guard lock(mutex_);
  waiting_ = false;
  if (!drawn_) return;
  tell("\r\x1b[K");
  drawn_ = false;
}

// Returns the earliest time of the next drawing.
ProgressBar::Clock::time_point ProgressBar::due() const {
  const auto after = [](Clock::time_point from, double seconds) {
    return from + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  };
  const Clock::time_point loud = after(work_start_, kQuietSeconds);
  return drawn_ ? std::max(loud, after(last_drawn_, kRedrawSeconds)) : loud;
}

void ProgressBar::draw() {
  last_drawn_ = Clock::now();
  // \r and "erase to the end of the line": the line is redrawn in place.
  tell(fmt::format("\r{}\x1b[K", progress_line(said_, fraction_, seconds_between(stage_start_, last_drawn_))));
  drawn_ = true;
  waiting_ = false;
}

// Draws the latest report, unless another one arrives in time.
void ProgressBar::draw_when_due() {
  std::unique_lock lock(mutex_);
  while (!over_) {
    if (!waiting_)
      changed_.wait(lock);
    else if (Clock::now() >= due())
      draw();
    else
      changed_.wait_until(lock, due());
  }
}

}  // namespace burin
