#include "burin/base/threads.h"

#include <tbb/global_control.h>

#include <string>

#include "burin/base/error.h"

/// OpenMP's function, present if some library of this process brings OpenMP (SuiteSparse, LibRaw).
extern "C" void omp_set_num_threads(int count) __attribute__((weak));

namespace burin {
namespace {

/// OpenMP and OpenImageIO (pictures/picture_file.cpp) have their own threads; all other libraries (OpenCV, Embree) use
/// TBB's.
void follow_limit() {
  if (omp_set_num_threads != nullptr) omp_set_num_threads(thread_count());
}

std::size_t checked(int most_threads) {
  if (most_threads < 1) fail("threads", std::to_string(most_threads) + " threads cannot work", "give 1 or more");
  return static_cast<std::size_t>(most_threads);
}

}  // namespace

struct ThreadLimit::State {
  explicit State(int most_threads) : control(tbb::global_control::max_allowed_parallelism, checked(most_threads)) {}
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int most_threads) : state_(std::make_unique<State>(most_threads)) { follow_limit(); }

ThreadLimit::~ThreadLimit() {
  state_.reset();
  follow_limit();
}

int thread_count() {
  return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

}  // namespace burin
