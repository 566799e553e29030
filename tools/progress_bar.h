// tools/progress_bar.h - progress and remaining time as one line, redrawn in place. It appears on a terminal only
// (stderr), and only after two seconds of work. A thread draws the line during long silent stages.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "burin/base/progress.h"

namespace burin {

/// Progress of one piece of work with any number of stages. Owns the terminal's line until clear() or destruction.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Returns the callback for a library. Call it from the thread that made the bar. It refers to *this, so the bar must
  /// outlive the work.
  Progress progress();

  /// Removes the line from the terminal. Call it before any other output.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  void show(std::string_view stage, double fraction);
  Clock::time_point due() const;
  void draw();
  void draw_when_due();

  const bool on_terminal_;
  std::mutex mutex_;  // guards all members below and the terminal's line
  std::condition_variable changed_;
  bool drawn_ = false, waiting_ = false, over_ = false;  // waiting: the latest report is not drawn yet
  Clock::time_point work_start_, stage_start_, last_drawn_;
  std::string stage_, said_;
  double fraction_ = 0;
  std::thread drawer_;  // starts with the first stage
  bool has_no_thread_ = false;
};

/// "[#########-----------]  45 %  finding tags, 1:20 left". The time extrapolates the stage; below 5 % it is missing.
std::string progress_line(std::string_view stage, double fraction, double stage_elapsed_s);

}  // namespace burin
