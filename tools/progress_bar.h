// tools/progress_bar.h - how far the work is and how long it will still take, as one line that is redrawn in place.
// Only on a terminal (stderr), and only once the work has taken two seconds: pipes and short work stay quiet. Work that
// says its stage and is then long silent is shown all the same: by a thread, which is there on a terminal only.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "burin/base/progress.h"

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
  Clock::time_point due() const;
  void draw();
  void draw_when_due();

  const bool on_terminal_;
  std::mutex mutex_;  // of all below, and of the terminal's line
  std::condition_variable changed_;
  bool drawn_ = false, waiting_ = false, over_ = false;  // waiting: what was said last is not drawn yet
  Clock::time_point work_start_, stage_start_, last_drawn_;
  std::string stage_, said_;
  double fraction_ = 0;
  std::thread drawer_;  // begun with the first stage
  bool has_no_thread_ = false;
};

/// "[#########-----------]  45 %  finding tags, 1:20 left". The time is a guess from the stage so far; none before 5 %.
std::string progress_line(std::string_view stage, double fraction, double stage_elapsed_s);

}  // namespace burin
