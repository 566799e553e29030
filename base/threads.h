// burin/base/threads.h - how many threads Burin may use.
//
// Everything runs on all of the machine's cores unless a program says otherwise. Results are the same bits for any
// number.
#pragma once

#include <memory>

namespace burin {

/// While it lives, all of Burin uses at most so many threads, the calling one included: renderers, designs, calibration
/// and the reading of pictures. Several may live at once; the smallest counts.
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

/// How many threads work may use now: the machine's cores, or the smallest ThreadLimit that lives. For libraries that
/// want to be told a number.
int thread_count();

}  // namespace burin
