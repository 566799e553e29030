// Proves: a ThreadLimit is kept by the work that runs under it, ends with it, and changes no bit of a picture.
#include "burin/base/threads.h"

#include <gmock/gmock.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "burin/base/error.h"
#include "tests/render/small_world.h"

namespace burin {
namespace {

/// The most bodies of a loop that ran at once.
int most_at_once() {
  std::atomic<int> now{0}, most{0};
  tbb::parallel_for(0, 64, [&](int) {
    const int here = ++now;
    for (int seen = most; seen < here && !most.compare_exchange_weak(seen, here);) {
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    --now;
  });
  return most;
}

TEST(ThreadLimit, HoldsWhileItLivesAndTheSmallestCounts) {
  const int before = thread_count();
  EXPECT_GE(before, 1);
  {
    const ThreadLimit three(3);
    EXPECT_EQ(thread_count(), 3);
    {
      const ThreadLimit one(1);
      EXPECT_EQ(thread_count(), 1);
      EXPECT_EQ(most_at_once(), 1);
    }
    EXPECT_EQ(thread_count(), 3);
    EXPECT_LE(most_at_once(), 3);
  }
  EXPECT_EQ(thread_count(), before);
}

TEST(ThreadLimit, FewerThanOneThreadIsRefused) {
  EXPECT_THROW(ThreadLimit(0), Error);
  EXPECT_THROW(ThreadLimit(-2), Error);
}

TEST(ThreadLimit, ChangesNoBitOfAPictureOrAGradient) {
  const World w = small_world();
  const Image weights = random_weights(w, 1, 9);
  Image first;
  ScratchGradients by_first;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    ViewRenderer renderer(w.scene);
    Image radiance;
    renderer.forward_with_jacobian(in_metal(w.scratches), radiance);
    const ScratchGradients gradients = renderer.backward(weights);
    if (threads == 1) {
      first = radiance;
      by_first = gradients;
    }
    EXPECT_EQ(radiance.data, first.data) << threads;
    EXPECT_EQ(gradients.x0_mm, by_first.x0_mm) << threads;
    EXPECT_EQ(gradients.shared_alpha, by_first.shared_alpha) << threads;
  }
}

}  // namespace
}  // namespace burin
