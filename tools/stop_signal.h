// tools/stop_signal.h - being asked to stop, by Ctrl-C (SIGINT), by `kill` (SIGTERM), by a terminal that closes
// (SIGHUP) or by any other signal that would end a process; and what becomes of faults.
//
// One way for all commands. main() calls end_on_signals(); from then on a signal ends the process wherever it is: what
// is being put in its place is still put there, all else that is unfinished is removed
// (burin/base/files/unfinished.h), one sentence is said, and the exit code is 128 and the signal's number. This is
// done by a thread of its own, so that no loop of ours or of a library has to ask. It is as safe as a power cut, since
// every result is put in its place in one step (docs/reliability.md).
//
// Work that is worth keeping (a design, a shoot with a camera on a cable) creates a StopOnSignal: while one lives, the
// first signal only sets a flag, and the work ends with what it has; the exit code is the same. A second signal ends at
// once, and so does Ctrl-\ (SIGQUIT).
#pragma once

#include <chrono>
#include <exception>
#include <functional>
#include <string>

namespace burin {

/// How a process that ends before its time speaks, while its other threads still run.
struct StopWords {
  /// The sentence and the exit code, before the end.
  std::function<void(const std::string&, int)> last;
  /// That a wish was heard by work that may take a while to end; may be empty.
  std::function<void(const std::string&)> heard;
  /// The sentence for an exception that nothing has caught; null where there is none.
  std::function<std::string(const std::exception_ptr&)> uncaught;
};

/// Begins it; once a process. Signals that were ignored (nohup) stay ignored. A pipe that nobody reads and a limit on
/// files' sizes are errors of the write from then on, not signals. An exception that nothing catches ends the process
/// with exit code 1. Throws Error where the system gives no thread.
void end_on_signals(const std::string& command_line, StopWords words);

/// The exit code of a process that a signal asked to stop: 130, 143, 129, ...; 0 while none has come.
int stop_exit_code();

/// The sentence about it: "stopped by Ctrl-C (SIGINT); ...". `kept`: the work ended with what it had.
std::string stop_sentence(bool kept = false);

/// For whoever is about to say the last that a command says, such as an error: a signal that comes later lets it be
/// said to its end, with its exit code, and says nothing itself. Where a signal came first and the process is being
/// ended by it, this does not return.
void take_last_word();

/// What stop_if_asked() throws: no error, and caught by run_program() alone.
struct Stopped {};

/// Between two steps of something long: throws Stopped if a signal has come.
void stop_if_asked();

/// While one lives, the first signal only sets a flag; another one, half a second later or more, ends the process.
class StopOnSignal {
 public:
  static constexpr std::chrono::milliseconds kAnyTime = std::chrono::milliseconds::max();

  /// `longest`: how long the work may take to end by itself after the first signal; then the process ends.
  explicit StopOnSignal(std::chrono::milliseconds longest = kAnyTime);
  ~StopOnSignal();
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

  /// Whether a signal has come.
  static bool asked();

 private:
  std::chrono::milliseconds longest_before_;
};

}  // namespace burin
