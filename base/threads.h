// burin/base/threads.h - the number of threads that Burin may use.
//
// By default everything runs on all of the machine's cores. Results are bit-identical for any number of threads.
#pragma once

#include <memory>

namespace burin {

/// During its lifetime, renderers, designs, calibration and picture readers use at most `most_threads` threads, the
/// calling one included. Of several objects, the smallest limit counts.
class ThreadLimit {
 public:
  /// Throws Error for fewer than one thread.
  explicit ThreadLimit(int most_threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Permitted number of threads: the machine's cores, or the smallest active ThreadLimit. It serves libraries that take
/// a number.
int thread_count();

}  // namespace burin
