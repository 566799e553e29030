// Proves the picture figures on cases worked by hand, SSIM on constant pictures, where it has a closed form.
#include "burin/optimize/loss/picture_metrics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "burin/base/error.h"
#include "burin/optimize/loss/loss.h"

namespace burin {
namespace {

Image pattern(int seed) {
  Image image(40, 30, 1);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) image.at(x, y) = 0.5F + 0.4F * std::sin(0.3F * x + seed) * std::cos(0.2F * y * seed);
  return image;
}

TEST(PictureMetrics, PsnrByHand) {
  EXPECT_NEAR(psnr_db(Image(20, 20, 1, 0.5F), Image(20, 20, 1, 0.6F)), 20, 1e-4);
  EXPECT_EQ(psnr_db(pattern(1), pattern(1)), 99);
  Image mask(20, 20, 1, 0.0F), a(20, 20, 1, 0.0F);
  mask.at(3, 3) = 1;
  a.at(3, 3) = 0.01F;
  a.at(7, 7) = 1;
  EXPECT_NEAR(psnr_db(a, Image(20, 20, 1, 0.0F), mask), 40, 1e-3);
}

TEST(PictureMetrics, SsimOfEqualInvertedAndConstantPictures) {
  EXPECT_NEAR(ssim(pattern(1), pattern(1)), 1, 1e-9);
  Image inverted = pattern(1);
  for (float& v : inverted.data) v = 1 - v;
  EXPECT_LT(ssim(pattern(1), inverted), 0);
  // No variance: only the luminance term is left.
  EXPECT_NEAR(ssim(Image(20, 20, 1, 0.4F), Image(20, 20, 1, 0.8F)), (2 * 0.32 + 1e-4) / (0.16 + 0.64 + 1e-4), 1e-5);
}

TEST(PictureMetrics, Correlation) {
  Image scaled = pattern(1);
  for (float& v : scaled.data) v = 0.2F + 0.3F * v;
  EXPECT_NEAR(correlation(pattern(1), scaled), 1, 1e-5);
  EXPECT_EQ(correlation(pattern(1), Image(40, 30, 1, 0.3F)), 0);
}

TEST(PictureMetrics, WhatTheMaskTakesOutDoesNotCount) {
  // A picture that is right but for what the mask takes out, whatever stands there.
  Image spoilt = pattern(1), mask(spoilt.width, spoilt.height, 1, 1.0F);
  for (int y = 8; y < 20; ++y)
    for (int x = 10; x < 16; ++x) {
      spoilt.at(x, y) = 1 - spoilt.at(x, y);
      mask.at(x, y) = 0;
    }
  EXPECT_LT(ssim(spoilt, pattern(1)), 0.95);
  EXPECT_LT(correlation(spoilt, pattern(1)), 0.99);
  EXPECT_NEAR(ssim(spoilt, pattern(1), mask), 1, 1e-9);
  EXPECT_NEAR(correlation(spoilt, pattern(1), mask), 1, 1e-9);
  // A mask of one value everywhere changes nothing.
  const Image half(spoilt.width, spoilt.height, 1, 0.5F);
  EXPECT_NEAR(ssim(spoilt, pattern(1), half), ssim(spoilt, pattern(1)), 1e-9);
  EXPECT_NEAR(correlation(spoilt, pattern(1), half), correlation(spoilt, pattern(1)), 1e-9);
}

TEST(PictureMetrics, BestExposureFindsTheScale) {
  const Image target = pattern(2);
  Image radiance = target;
  for (float& v : radiance.data) v = std::pow(v, 2.2F) / 5;
  for (const double guess : {1.0, 5.0, 30.0}) EXPECT_NEAR(best_exposure(radiance, target, guess), 5, 0.02);
}

TEST(PictureMetrics, SizesMustAgree) {
  EXPECT_THROW(psnr_db(Image(4, 4, 1), Image(5, 4, 1)), Error);
  EXPECT_THROW(ssim(Image(4, 4, 1), Image(4, 4, 1)), Error);
}

}  // namespace
}  // namespace burin
