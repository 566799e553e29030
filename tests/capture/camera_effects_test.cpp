// Proves: a response takes back an S-curve that is written another way, and is refused where it is not monotonic; an
// unsharp mask is taken back; pixels that measured green stay and fill the others; glare's two-part convolution is the
// sum over all pixels. Not proved: that photos have these (tests/capture/bracket_response_test.cpp).
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "burin/base/error.h"
#include "burin/capture/glare.h"
#include "burin/scene/files/camera_effects_json.h"
#include "burin/scene/response.h"
#include "burin/scene/sensor.h"

namespace burin {
namespace {

TEST(CameraEffects, AnSCurveIsTakenBack) {
  const double contrast = 1.4, pivot = 0.42;
  const Response response = s_curve(contrast, pivot);
  for (const double v : {0.02, 0.1, 0.3, 0.5, 0.77, 0.97}) {
    // The S-curve as a power of odds.
    const double odds = pivot / (1 - pivot) * std::pow(v / (1 - v) * (1 - pivot) / pivot, contrast);
    const double stored = odds / (1 + odds);
    EXPECT_NEAR(unbent(response, stored), v, 1e-12);
    EXPECT_NEAR(bent(response, v), stored, 1e-12);
  }
  EXPECT_TRUE(is_monotonic(response));
  EXPECT_EQ(unbent(response, 0), 0);
  EXPECT_EQ(unbent(response, 1), 1);
}

TEST(CameraEffects, ACurveThatFallsIsRefused) {
  Response bad;
  bad.bumps[2] = 3;
  EXPECT_FALSE(is_monotonic(bad));
  const Json json = response_json(bad);
  EXPECT_THROW(read_response(JsonObject(json, "bench.json")), Error);
  const Json good = response_json(s_curve(1.2, 0.5));
  EXPECT_NEAR(read_response(JsonObject(good, "bench.json")).slope, 1 / 1.2 - 1, 1e-15);
}

TEST(CameraEffects, AnUnsharpMaskIsTakenBack) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> value(0.3F, 0.6F);
  Image plain(64, 48, 3);
  for (float& v : plain.data) v = value(random);
  Image mean(64, 48, 1);
  for (std::size_t i = 0; i < mean.data.size(); ++i)
    mean.data[i] = (plain.data[3 * i] + plain.data[3 * i + 1] + plain.data[3 * i + 2]) / 3;
  const Sharpening mask{0.6, 1.1};
  const Image smooth = blurred(mean, mask.sigma_px);
  Image stored = plain;
  for (std::size_t i = 0; i < stored.data.size(); ++i)
    stored.data[i] += static_cast<float>(mask.amount) * (mean.data[i / 3] - smooth.data[i / 3]);
  unsharpened(mask, stored);
  for (std::size_t i = 0; i < stored.data.size(); ++i) EXPECT_NEAR(stored.data[i], plain.data[i], 1e-3);
}

TEST(CameraEffects, WhatDidNotMeasureGreenBecomesTheMeanOfWhatDidBesideIt) {
  Image image(3, 2, 3);
  for (int i = 0; i < 6; ++i)
    for (int c = 0; c < 3; ++c) image.at(i % 3, i / 3, c) = static_cast<float>(i + 10 * c);
  keep_green_sites(GreenSites::odd, image);  // (1, 0), (0, 1) and (2, 1) stay
  for (int c = 0; c < 3; ++c) {
    const auto base = static_cast<float>(10 * c);
    EXPECT_FLOAT_EQ(image.at(1, 0, c), base + 1);
    EXPECT_FLOAT_EQ(image.at(0, 1, c), base + 3);
    EXPECT_FLOAT_EQ(image.at(0, 0, c), base + 2);  // of 1 and 3
    EXPECT_FLOAT_EQ(image.at(1, 1, c), base + (1 + 3 + 5) / 3.F);
    EXPECT_FLOAT_EQ(image.at(2, 0, c), base + 3);  // of 1 and 5
  }
  Image lone(1, 1, 3);
  lone.at(0, 0, 1) = 0.5F;
  keep_green_sites(GreenSites::odd, lone);
  EXPECT_FLOAT_EQ(lone.at(0, 0, 1), 0.5F);
}

TEST(CameraEffects, GlareIsTheSumOverAllPixels) {
  Image image(90, 70, 1);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.at(x, y) = 1 + 0.5F * std::sin(0.11F * static_cast<float>(x)) + (x > 50 && y > 30 ? 2.0F : 0.0F);
  const Glare glare{0.01, 3, 40};
  const Image seen = glare_of(image, glare);
  for (const auto& [px, py] : {std::pair(45, 35), std::pair(52, 36), std::pair(44, 41)}) {
    double sum = 0, weight = 0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const double r2 = std::pow(x - px, 2) + std::pow(y - py, 2);
        if (r2 > glare.reach_px * glare.reach_px) continue;
        sum += image.at(x, y) / (r2 + glare.core_px * glare.core_px);
        weight += 1 / (r2 + glare.core_px * glare.core_px);
      }
    // Cells of four pixels err by up to a percent beside the step, as the header says; the sum stops at the picture's
    // rim.
    EXPECT_NEAR(seen.at(px, py), sum / weight, 0.03 * sum / weight) << px << ", " << py;
  }
}

}  // namespace
}  // namespace burin
