// Proves Adam's arithmetic on cases worked by hand and its convergence on a quadratic with very different scales.
#include "optimize/adam.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/error.h"

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

TEST(Adam, WrongSizeIsAnError) {
  Adam adam(2);
  std::vector<double> x{0};
  EXPECT_THROW(adam.step(x, std::vector<double>{1}, 1), Error);
}

}  // namespace
}  // namespace burin
