// Proves Adam's arithmetic on cases worked by hand and its convergence on a quadratic with very different scales.
#include "burin/optimize/loss/adam.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <utility>
#include <vector>

#include "burin/base/error.h"

namespace burin {
namespace {

TEST(Adam, FirstStepIsTheRateAgainstTheGradientsSign) {
  Adam adam(3);
  std::vector<double> x{1, 1, 1};
  adam.step(x, std::vector<double>{5, -0.001, 0}, 0.1);
  EXPECT_NEAR(x[0], 0.9, 1e-9);
  EXPECT_NEAR(x[1], 1.1, 1e-9);
  EXPECT_EQ(x[2], 1);
}

TEST(Adam, SecondStepByHand) {
  Adam adam(1);
  std::vector<double> x{0};
  adam.step(x, std::vector<double>{1}, 1);  // -1
  adam.step(x, std::vector<double>{-2}, 1);
  // mean = 0.9 * 0.1 - 0.2 = -0.11, / (1 - 0.81); square = 0.999 * 0.001 + 0.004, / (1 - 0.998001)
  EXPECT_NEAR(x[0], -1 + (0.11 / 0.19) / std::sqrt(0.004999 / 0.001999), 1e-9);
}

TEST(Adam, RestartAndKeepForgetTheRightOnes) {
  Adam adam(3), fresh(1);
  std::vector<double> x{0, 0, 0}, y{0};
  adam.step(x, std::vector<double>{1, 2, 3}, 1);
  adam.restart(2);
  adam.keep(std::vector<std::size_t>{0, 2});
  ASSERT_EQ(adam.size(), 2U);
  std::vector<double> z{0, 0};
  adam.step(z, std::vector<double>{-2, -7}, 1);
  fresh.step(y, std::vector<double>{-7}, 1);
  EXPECT_EQ(z[1], y[0]);
  EXPECT_NEAR(z[0], (0.11 / 0.19) / std::sqrt(0.004999 / 0.001999), 1e-9);
}

TEST(Adam, ConvergesWhateverTheScales) {
  Adam adam(2);
  std::vector<double> x{1, -1};
  for (int i = 0; i < 2000; ++i) adam.step(x, std::vector<double>{2e6 * (x[0] - 0.3), 2e-3 * (x[1] - 0.2)}, 1e-2);
  EXPECT_NEAR(x[0], 0.3, 1e-3);
  EXPECT_NEAR(x[1], 0.2, 1e-3);
}

TEST(Adam, ThreeHundredStepsAsWrittenDown) {
  // Kingma & Ba's Algorithm 1 a number at a time, with parameters that start anew now and then; 1, 2 and 5 threads.
  constexpr std::size_t kCount = 9001;  // some parts, none of them full packets
  const auto gradient_of = [](std::size_t i, int t) { return std::sin(0.37 * static_cast<double>(i) + 0.11 * t); };
  std::vector<double> expected(kCount, 0.5), mean(kCount, 0), square(kCount, 0), gradient(kCount);
  std::vector<int> age(kCount, 0);
  for (int t = 0; t < 300; ++t)
    for (std::size_t i = 0; i < kCount; ++i) {
      if (t % 100 == 50 && i % 7 == 3) mean[i] = square[i] = age[i] = 0;
      const double g = gradient_of(i, t);
      mean[i] = 0.9 * mean[i] + 0.1 * g;
      square[i] = 0.999 * square[i] + 0.001 * g * g;
      ++age[i];
      expected[i] -=
          1e-3 * mean[i] / (1 - std::pow(0.9, age[i])) / (std::sqrt(square[i] / (1 - std::pow(0.999, age[i]))) + 1e-12);
    }
  std::vector<double> first;
  for (const int threads : {1, 2, 5}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Adam adam(kCount);
    std::vector<double> x(kCount, 0.5);
    for (int t = 0; t < 300; ++t) {
      for (std::size_t i = 0; i < kCount; ++i) {
        if (t % 100 == 50 && i % 7 == 3) adam.restart(i);
        gradient[i] = gradient_of(i, t);
      }
      adam.step(x, gradient, 1e-3);
    }
    if (threads == 1) first = x;
    EXPECT_EQ(x, first) << threads << " threads";
    for (std::size_t i = 0; i < kCount; ++i) ASSERT_NEAR(x[i], expected[i], 1e-11);
  }
}

TEST(Adam, WrongSizeIsAnError) {
  Adam adam(2);
  std::vector<double> x{0};
  EXPECT_THROW(adam.step(x, std::vector<double>{1}, 1), Error);
}

TEST(Adam, HistoriesFollowTheirParametersIntoAnotherOrder) {
  Adam forward(3), backward(3);
  std::vector<double> p{1, 2, 3}, q = p;
  forward.step(p, std::vector<double>{1, -2, 0.5}, 0.1);
  backward.step(q, std::vector<double>{1, -2, 0.5}, 0.1);
  const std::vector<std::size_t> turned{2, 0, 1};
  backward.keep(turned);
  q = {q[2], q[0], q[1]};
  forward.step(p, std::vector<double>{3, 1, -1}, 0.1);
  backward.step(q, std::vector<double>{-1, 3, 1}, 0.1);
  EXPECT_EQ(q, (std::vector<double>{p[2], p[0], p[1]}));
}

TEST(Adam, ExchangesHistories) {
  Adam a(1), b(1);
  std::vector<double> p{1}, q{1};
  a.step(p, std::vector<double>{5}, 0.1);
  b.step(q, std::vector<double>{-1}, 0.1);
  a.exchange(0, b);
  std::swap(p, q);
  Adam c(1);
  std::vector<double> r{1};
  c.step(r, std::vector<double>{-1}, 0.1);
  a.step(p, std::vector<double>{2}, 0.1);
  c.step(r, std::vector<double>{2}, 0.1);
  EXPECT_EQ(p, r);
  EXPECT_THROW(a.exchange(0, b), Error);  // b is a step behind
}

}  // namespace
}  // namespace burin
