// How two photos compare at a glance: a photo lies exactly on itself, whatever its size, and a moved one by as much as
// it was moved. The pictures are smooth random blobs; the oracle is the shift that made them.
#include "burin/capture/photo_look.h"

#include <gtest/gtest.h>

#include <cmath>

namespace burin {
namespace {

// The same field of waves, seen from (dx, dy) further.
PhotoLook look_of(int width, int height, double dx, double dy) {
  PhotoLook look;
  look.small = {width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double v = 0;
      for (int k = 1; k <= 6; ++k) {
        const double a = 2.399963 * k, f = 0.15 + 0.08 * k;
        v += std::sin(f * ((x + dx) * std::cos(a) + (y + dy) * std::sin(a)) + k * k);
      }
      look.small.codes.push_back(SmallPhoto::code_of(0.3 * std::exp(0.2 * v)));
    }
  look.noise_floor = 1e-4;
  look.bright = 0.5;
  return look;
}

TEST(SmallPhoto, KeepsADigitMoreThanNoiseLeaves) {
  for (double value = 0.001; value < 1; value *= 1.01) {
    const std::uint16_t code = SmallPhoto::code_of(value);
    EXPECT_NEAR(SmallPhoto::value_of(code), value, 1e-3 * value);
    EXPECT_NE(code, SmallPhoto::kClipped);
  }
  EXPECT_EQ(SmallPhoto::value_of(SmallPhoto::code_of(1)), 1);
  EXPECT_EQ(SmallPhoto::code_of(-1), 0);
  EXPECT_EQ(SmallPhoto::code_of(7), SmallPhoto::kWhite) << "bright, and yet not clipped";
}

TEST(Compare, APhotoLiesOnItselfWhateverItsSize) {
  // 622 rows are transformed as 625: an odd size, for which OpenCV's phase correlation is half a pixel off.
  for (const auto& [width, height] : {std::pair{800, 622}, {800, 600}, {622, 800}, {243, 375}}) {
    const PhotoLook look = look_of(width, height, 0, 0);
    const auto same = compare(look, 1, look, 1);
    ASSERT_TRUE(same);
    EXPECT_NEAR(same->shift_px, 0, 0.02) << width << " x " << height;
    EXPECT_NEAR(same->correlation, 1, 1e-6);
  }
}

TEST(Compare, TellsHowFarAPhotoMoved) {
  const auto moved = compare(look_of(800, 622, 0, 0), 1, look_of(800, 622, 2, 1), 1);
  ASSERT_TRUE(moved);
  EXPECT_NEAR(moved->shift_px, std::hypot(2, 1), 0.2);
}

}  // namespace
}  // namespace burin
