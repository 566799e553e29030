// tools/stop_signal.h - being asked to stop, by Ctrl-C, by `kill` or by a terminal that closes: long work ends with
// what it has, and says that it is not done.
#pragma once

namespace burin {

/// While it lives, the first SIGINT, SIGTERM or SIGHUP only sets a flag; another one, half a second
/// later or more, ends the program as usual. A signal that was ignored (nohup) stays ignored. One at a time.
class StopOnSignal {
 public:
  StopOnSignal();
  ~StopOnSignal();
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

  /// Whether such a signal has come since this began.
  static bool asked();

 private:
  using Handler = void (*)(int);
  Handler before_[3];
};

}  // namespace burin
