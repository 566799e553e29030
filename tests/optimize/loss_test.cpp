// Proves that every term of the picture loss and the gamma curve has the gradient it claims, against finite
// differences; that each term sees what it should (E_p blind to a checkerboard, Gram not; Gram blind to where a texture
// sits inside its tile); that masked pixels count for nothing; that threads change no bit.
#include "optimize/loss.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "render/error.h"

namespace burin {
namespace {

Image noise(int width, int height, unsigned seed, float low = 0, float high = 1) {
  std::mt19937 random(seed);
  Image image(width, height, 1);
  for (float& v : image.data) v = low + (high - low) * static_cast<float>(random() & 0xffffff) / 0x1000000;
  return image;
}

// Directional derivative by differences along `direction`, next to the gradient's claim.
void expect_gradient(const LossWeights& weights, const Image& mask) {
  const int w = 70, h = 45;  // neither a multiple of tiles nor even on every scale
  PictureLoss loss(noise(w, h, 1), mask, weights);
  const Image picture = noise(w, h, 2);
  Image gradient, scratch;
  loss.evaluate(picture, gradient);
  for (unsigned seed = 10; seed < 16; ++seed) {
    const Image direction = noise(w, h, seed, -1, 1);
    double claimed = 0;
    for (std::size_t i = 0; i < direction.data.size(); ++i)
      claimed += static_cast<double>(gradient.data[i]) * direction.data[i];
    // E is a polynomial of degree <= 4, for which the five-point difference is exact whatever the step: so a large one,
    // against float rounding.
    const auto at = [&](float step) {
      Image moved = picture;
      for (std::size_t i = 0; i < moved.data.size(); ++i) moved.data[i] += step * direction.data[i];
      return loss.evaluate(moved, scratch).total;
    };
    const float step = 0.1F;
    const double slope =
        (8 * (at(step) - at(-step)) - (at(2 * step) - at(-2 * step))) / (12 * static_cast<double>(step));
    double norm = 0;
    for (const float g : gradient.data) norm += static_cast<double>(g) * g;
    EXPECT_NEAR(slope, claimed, 1e-3 * std::sqrt(norm)) << "seed " << seed;
  }
}

TEST(Loss, GradientOfThePerceptualTerm) { expect_gradient({1, 0, 0}, {}); }
TEST(Loss, GradientOfL2) { expect_gradient({0, 1, 0}, {}); }
TEST(Loss, GradientOfTheGramTerm) { expect_gradient({0, 0, 0.01}, {}); }
TEST(Loss, GradientOfAllTermsMasked) { expect_gradient({0.7, 0.2, 0.01}, noise(70, 45, 3)); }

TEST(Loss, GradientOfSinglePixelsIncludingCornersAndTileEdges) {
  PictureLoss loss(noise(70, 45, 1), {}, {1, 0.5, 0.01});
  Image picture = noise(70, 45, 2);
  Image gradient, scratch;
  loss.evaluate(picture, gradient);
  for (const auto& [x, y] : {std::pair{0, 0}, {69, 44}, {31, 31}, {32, 32}, {31, 32}, {64, 10}, {69, 0}, {1, 1}}) {
    const float before = picture.at(x, y);
    picture.at(x, y) = before + 0.05F;
    const double up = loss.evaluate(picture, scratch).total;
    picture.at(x, y) = before - 0.05F;
    const double down = loss.evaluate(picture, scratch).total;
    picture.at(x, y) = before;
    EXPECT_NEAR((up - down) / 0.1, gradient.at(x, y), 5e-3) << x << ", " << y;
  }
}

TEST(Loss, IsZeroAtTheTargetAndItsGradientToo) {
  const Image target = noise(64, 64, 5);
  PictureLoss loss(target, {}, {1, 1, 1});
  Image gradient;
  const LossValue value = loss.evaluate(target, gradient);
  EXPECT_NEAR(value.total, 0, 1e-6);
  EXPECT_THAT(gradient.data, testing::Each(testing::FloatNear(0, 1e-3F)));
}

TEST(Loss, PerceptualTermIsBlindToACheckerboardAndGramIsNot) {
  Image flat(64, 64, 1, 0.5F), checker = flat;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) checker.at(x, y) += (x + y) % 2 == 0 ? 0.1F : -0.1F;
  PictureLoss loss(flat, {}, {1, 1, 1});
  Image gradient;
  const LossValue value = loss.evaluate(checker, gradient);
  EXPECT_NEAR(value.l2, 64 * 64 * 0.01, 1e-2);
  EXPECT_LT(value.perceptual, 0.02 * value.l2);  // only the border row and column remain
  // A patch's power is 9 * 0.01, of which its mean (+-0.1 / 9 a pixel) takes 0.01 / 9; one direction holds the rest.
  const double power = 0.09 - 0.01 / 9;
  EXPECT_NEAR(value.gram, kGramUnit * 62 * 62 * power * power, 1.0);
}

TEST(Loss, MaskedPixelsDoNotMatter) {
  const Image target = noise(64, 64, 1);
  Image mask(64, 64, 1, 1.0F);
  for (int y = 20; y < 40; ++y)
    for (int x = 20; x < 40; ++x) mask.at(x, y) = 0;
  PictureLoss loss(target, mask, {1, 1, 0.01});
  Image picture = target;
  for (int y = 20; y < 40; ++y)
    for (int x = 20; x < 40; ++x) picture.at(x, y) = 0;
  Image gradient;
  EXPECT_NEAR(loss.evaluate(picture, gradient).total, 0, 1e-6);
}

TEST(Loss, GammaGradient) {
  Image radiance = noise(20, 10, 4);
  radiance.data[3] = 0;
  radiance.data[4] = -1e-9F;
  const double exposure = 1.7, step = 1e-4;
  Image picture, up, down, d_radiance;
  picture_from_radiance(radiance, exposure, picture);
  const Image d_picture = noise(20, 10, 6, -1, 1);
  const double d_log = radiance_gradient(radiance, exposure, picture, d_picture, d_radiance);
  picture_from_radiance(radiance, exposure * std::exp(step), up);
  picture_from_radiance(radiance, exposure * std::exp(-step), down);
  double numeric = 0;
  for (std::size_t i = 0; i < up.data.size(); ++i)
    numeric += static_cast<double>(d_picture.data[i]) * (up.data[i] - down.data[i]) / (2 * step);
  EXPECT_NEAR(d_log, numeric, 5e-3);
  for (const int i : {0, 10, 100}) {
    const double d = 1e-3 * radiance.data[i];
    Image moved = radiance;
    moved.data[i] += static_cast<float>(d);
    picture_from_radiance(moved, exposure, up);
    moved.data[i] = radiance.data[i] - static_cast<float>(d);
    picture_from_radiance(moved, exposure, down);
    EXPECT_NEAR((up.data[i] - down.data[i]) / (2 * d) * d_picture.data[i], d_radiance.data[i],
                1e-2 * std::abs(d_radiance.data[i]) + 1e-3);
  }
  EXPECT_EQ(d_radiance.data[4], 0);
}

TEST(Loss, TargetsAndPicturesShareTheGammaOffset) {
  const Image encoded = noise(16, 16, 8);
  Image radiance = encoded, picture;
  for (float& v : radiance.data) v = std::pow(v, 2.2F) / 3;
  picture_from_radiance(radiance, 3, picture);
  const Image expected = with_gamma_offset(encoded), shown = shown_picture(radiance, 3);
  for (std::size_t i = 0; i < encoded.data.size(); ++i) {
    EXPECT_NEAR(picture.data[i], expected.data[i], 1e-5);
    EXPECT_NEAR(shown.data[i], encoded.data[i], 1e-5);
  }
}

TEST(Loss, WrongSizesAreErrors) {
  EXPECT_THROW(PictureLoss(noise(8, 8, 1), noise(9, 8, 1), {}), Error);
  PictureLoss loss(noise(8, 8, 1), {}, {});
  Image gradient;
  EXPECT_THROW(loss.evaluate(noise(8, 9, 1), gradient), Error);
}

}  // namespace
}  // namespace burin
