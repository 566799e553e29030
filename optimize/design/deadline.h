// burin/optimize/design/deadline.h - end of a design: its time limit, counted from the design's start, or a stop by the
// caller.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <utility>

namespace burin {

class Deadline {
 public:
  /// `limit_s` 0: no limit. `stop`: as in DesignOptions; may be empty.
  Deadline(double limit_s, std::function<bool()> stop) : limit_s_(limit_s), stop_(std::move(stop)) {}

  double seconds() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }

  /// Whether the caller has stopped the work. Several threads may call it at once. A stop is permanent.
  bool wished() {
    if (!wished_ && stop_ && stop_()) wished_ = true;
    return wished_.load();
  }

  /// Whether this share of the time will be over in `ahead_s` seconds.
  bool used(double share, double ahead_s = 0) const { return limit_s_ > 0 && seconds() + ahead_s > share * limit_s_; }

  bool wished_or_used(double share, double ahead_s = 0) { return wished() || used(share, ahead_s); }

  /// The elapsed part of the time from `began_s` on, with `ahead_s` reserved for later stages; 0 without a limit.
  double part_since(double began_s, double ahead_s) const {
    if (!(limit_s_ > 0)) return 0;
    const double there_is_s = limit_s_ - ahead_s - began_s;
    return there_is_s > 0 ? std::clamp((seconds() - began_s) / there_is_s, 0.0, 1.0) : 1;
  }

 private:
  using Clock = std::chrono::steady_clock;

  Clock::time_point began_ = Clock::now();
  double limit_s_;
  std::function<bool()> stop_;
  std::atomic<bool> wished_{false};
};

}  // namespace burin
