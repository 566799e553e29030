// What is proved: a field's mean over the board is one, so that what it multiplies stays the mean; scratches get the
// factor of their middle and of their place in the carving order; constant fields change nothing; no field makes a
// depth that is not positive or a roughness above one.
#include "burin/render/groove_field.h"

#include <gtest/gtest.h>

namespace burin {
namespace {

Scratches three() {
  Scratches s;
  s.x0_mm = {0, 40, 90};
  s.x1_mm = {20, 60, 110};
  s.y0_mm = s.y1_mm = {10, 25, 45};
  return s;
}

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

TEST(GrooveField, EachScratchGetsItsPlaceAndItsAge) {
  Scratches s = three();
  GrooveField depth, alpha;
  depth.terms = {0.2, 0, 0, 0, 0, 0.1};
  apply_fields(depth, alpha, 10, 0.06, {100, 50}, s);
  ASSERT_EQ(s.depth_um.size(), 3U);
  EXPECT_NEAR(s.depth_um[0], 10 * (1 + 0.2 * -0.4) * (1 + 0.1 * 0.5), 1e-12);
  EXPECT_NEAR(s.depth_um[1], 10, 1e-12);
  EXPECT_NEAR(s.depth_um[2], 10 * (1 + 0.2 * 0.5) * (1 - 0.1 * 0.5), 1e-12);
  EXPECT_TRUE(s.alpha.empty());  // constant: nothing is written
}

TEST(GrooveField, StaysWithinWhatGroovesCanBe) {
  Scratches s = three();
  GrooveField depth, alpha;
  depth.terms[0] = 10;
  alpha.terms[0] = 10;
  apply_fields(depth, alpha, 10, 0.5, {100, 50}, s);
  for (std::size_t i = 0; i < s.size(); ++i) {
    EXPECT_GT(s.depth_um[i], 0);
    EXPECT_GT(s.alpha[i], 0);
    EXPECT_LE(s.alpha[i], 1);
  }
}

}  // namespace
}  // namespace burin
