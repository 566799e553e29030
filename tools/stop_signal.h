// tools/stop_signal.h - requests to stop, and uncaught faults. Requests are Ctrl-C (SIGINT), `kill` (SIGTERM), a closed
// terminal (SIGHUP) and all other terminating signals.
//
// All commands use one mechanism. main() calls end_on_signals(). Afterwards a signal ends the process at any point.
// Outputs that are being renamed into place are completed, and all other unfinished files are removed
// (burin/base/files/unfinished.h). The process prints one sentence and exits with 128 plus the signal's number. A
// separate thread does this, so that no loop of Burin or of a library needs to poll. It is as safe as a power cut,
// since every result reaches its place in one step (docs/reliability.md).
//
// Valuable work (a design, a tethered shoot) creates a StopOnSignal. During its lifetime, the first signal only sets a
// flag, and the work ends with its present result and the same exit code. A second signal ends the process at once, and
// so does Ctrl-\ (SIGQUIT).
#pragma once

#include <chrono>
#include <exception>
#include <functional>
#include <string>

namespace burin {

/// Messages of a process that ends early while its other threads still run.
struct StopWords {
  /// Prints the sentence, with the exit code, before the end.
  std::function<void(const std::string&, int)> last;
  /// Confirms a request during work that may take a while to end; may be empty.
  std::function<void(const std::string&)> heard;
  /// Returns the sentence for an uncaught exception; null for none.
  std::function<std::string(const std::exception_ptr&)> uncaught;
};

/// Starts the handling of signals; call it once per process. Ignored signals (nohup) stay ignored. A broken pipe and a
/// file size limit become write errors instead of signals. An uncaught exception ends the process with exit code 1.
/// Throws Error if no thread can be created.
void end_on_signals(const std::string& command_line, StopWords words);

/// Exit code of a process after a request to stop: 130, 143, 129, ...; 0 without one.
int stop_exit_code();

/// Returns the sentence about the request: "stopped by Ctrl-C (SIGINT) before it was done; ...". `kept`: the work kept
/// its result.
std::string stop_sentence(bool kept = false);

/// Call this before a command's last message, such as an error. A later signal then waits for the message and keeps its
/// exit code, without its own message. If an earlier signal is already ending the process, this does not return.
void take_last_word();

/// Thrown by stop_if_asked() and caught only by run_program(). It is not an error.
struct Stopped {};

/// Throws Stopped after a request to stop. Call it between two steps of long work.
void stop_if_asked();

/// Defers the first signal during its lifetime: it only sets a flag. Another one, half a second later or more, ends the
/// process.
class StopOnSignal {
 public:
  static constexpr std::chrono::milliseconds kAnyTime = std::chrono::milliseconds::max();

  /// `longest`: time limit for the work to end after the first signal; then the process ends.
  explicit StopOnSignal(std::chrono::milliseconds longest = kAnyTime);
  ~StopOnSignal();
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

  /// Returns true after a request to stop.
  static bool asked();

 private:
  std::chrono::milliseconds longest_before_;
};

}  // namespace burin
