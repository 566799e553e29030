// tools/stop_signal.h - being asked to stop, by Ctrl-C (SIGINT), by `kill` (SIGTERM) or by a terminal that closes
// (SIGHUP).
//
// One way for all commands. main() calls end_on_signals(); from then on a signal ends the process wherever it is: what
// is being put in its place is still put there, all else that is unfinished is removed
// (burin/render/files/unfinished.h), one sentence is said, and the exit code is 130, 143 or 129. This is done by a
// thread of its own, so that no loop of ours or of a library has to ask. It is as safe as a power cut, since every
// result is put in its place in one step (docs/reliability.md).
//
// Work that is worth keeping (a design, a shoot with a camera on a cable) says StopOnSignal: while one lives, the first
// signal only sets a flag, and the work ends with what it has; the exit code is the same. A second signal ends at once.
#pragma once

#include <functional>
#include <string>

namespace burin {

/// Begins it; once a process. `say` is called with the sentence and the exit code by the thread that ends the process,
/// while all others still run. A SIGHUP that was ignored (nohup) stays ignored.
void end_on_signals(const std::string& command_line, std::function<void(const std::string&, int)> say);

/// The exit code of a process that a signal asked to stop: 130, 143 or 129; 0 while none has come.
int stop_exit_code();

/// What is said of it: "stopped by Ctrl-C (SIGINT); ...".
std::string stop_sentence();

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
  StopOnSignal();
  ~StopOnSignal();
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

  /// Whether a signal has come.
  static bool asked();
};

}  // namespace burin
