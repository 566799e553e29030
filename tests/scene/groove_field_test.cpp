// What is proved: a field's mean over the board is one, so that what it multiplies stays the mean. What it does to
// scratches: carve_test.cpp.
#include "burin/scene/groove_field.h"

#include <gtest/gtest.h>

namespace burin {
namespace {

TEST(GrooveField, MeanOverTheBoardIsOne) {
  const std::array<double, GrooveField::kTerms> terms{0.2, -0.1, 0.3, 0.2, -0.4, 0.1};
  double sum = 0, ages = 0;
  constexpr int kSteps = 400;
  for (int j = 0; j < kSteps; ++j) {
    for (int i = 0; i < kSteps; ++i) sum += field_over_board(terms, (i + 0.5) / kSteps, (j + 0.5) / kSteps);
    ages += field_at_age(terms, (j + 0.5) / kSteps);
  }
  EXPECT_NEAR(sum / (kSteps * kSteps), 1, 1e-5);
  EXPECT_NEAR(ages / kSteps, 1, 1e-12);
}

}  // namespace
}  // namespace burin
