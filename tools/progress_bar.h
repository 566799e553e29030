// tools/progress_bar.h - how far the work is and how long it will still take, as one line that is redrawn in place.
// Only on a terminal (stderr), and only once the work has taken two seconds: pipes and short work stay quiet.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "burin/render/progress.h"

namespace burin {

/// One piece of work, which may go through several stages. Owns the terminal's line until clear() or its end.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// What a library takes: call it from the thread that made the bar. Refers to *this: the bar must outlive the work.
  Progress progress();

  /// Takes the line off the terminal: call it before printing anything else.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  void show(std::string_view stage, double fraction);

  bool on_terminal_;
  bool drawn_ = false;
  Clock::time_point work_start_, stage_start_, last_drawn_;
  std::string stage_;
};

/// "[#########-----------]  45 %  finding tags, 1:20 left". The time is a guess from the stage so far; none before 5 %.
std::string progress_line(std::string_view stage, double fraction, double stage_elapsed_s);

}  // namespace burin
