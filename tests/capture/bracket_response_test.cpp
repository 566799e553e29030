// Proves: a camera's curve and its photos' own exposures come out of brackets of drawn photos (noise, 8 bits), a plain
// camera is found to have none, a bracket that contradicts its EXIF is named, and single exposures tell nothing. The
// photos' curve is written here as a power of odds, not as the library has it.
#include "burin/capture/bracket_response.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "burin/base/image.h"
#include "burin/pictures/picture.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

struct Drawn {
  double contrast = 1, pivot = 0.45;
  double wrong_factor = 1;  // of the second view's longest exposure, against what its session says
  int exposures = 3;
  double noise = 0.006;  // of white, at white
  int grain = 1;         // pixels that share it along x and y, as denoising leaves it
};

Session draw(const TemporaryFolder& folder, const Drawn& how) {
  Session session;
  session.file = folder / "session.json";
  for (int view = 0; view < 4; ++view) {
    std::mt19937 random(100 + view);
    std::uniform_real_distribution<double> level(-7, 0);
    Image light(256, 192, 3);
    for (int ty = 0; ty < 12; ++ty)
      for (int tx = 0; tx < 16; ++tx) {
        const double v = std::exp2(level(random));
        for (int y = 0; y < 16; ++y)
          for (int x = 0; x < 16; ++x)
            for (int c = 0; c < 3; ++c) light.at(16 * tx + x, 16 * ty + y, c) = static_cast<float>(v * (1 + 0.1 * c));
      }
    for (int e = 0; e < how.exposures; ++e) {
      std::normal_distribution<double> noise;
      const double factor = std::pow(4, e - 1), real = factor * (view == 1 && e == 2 ? how.wrong_factor : 1);
      Image stored = light;
      std::vector<double> noises(light.data.size());
      for (double& n : noises) n = noise(random);
      for (std::size_t i = 0; i < stored.data.size(); ++i) {
        float& v = stored.data[i];
        const int x = static_cast<int>(i / 3) % light.width, y = static_cast<int>(i / 3) / light.width;
        const double n = noises[3 * (static_cast<std::size_t>(y / how.grain) * light.width + x / how.grain) + i % 3],
                     linear = std::clamp(v * real + how.noise * std::sqrt(v * real) * n, 0.0, 1.0);
        double s = linear_to_srgb(static_cast<float>(linear));
        if (how.contrast != 1 && s > 0 && s < 1) {
          const double odds =
              how.pivot / (1 - how.pivot) * std::pow(s / (1 - s) * (1 - how.pivot) / how.pivot, how.contrast);
          s = odds / (1 + odds);
        }
        v = static_cast<float>(s);
      }
      Photo photo;
      photo.view = "v" + std::to_string(view);
      photo.file = folder / (photo.view + "_" + std::to_string(e) + ".png");
      photo.exposure_s = 0.01 * factor;
      photo.f_number = 8;
      photo.encoding = Encoding::srgb;
      write_picture(stored, photo.file);
      session.photos.push_back(photo);
    }
  }
  return session;
}

// The logarithm of the light that is stored as s.
double light(const Response& r, double s) {
  return std::log(static_cast<double>(srgb_to_linear(static_cast<float>(unbent(r, s)))));
}

TEST(BracketResponse, FindsAnSCurve) {
  const TemporaryFolder folder;
  const BracketResponse found = bracket_response(draw(folder, {1.3, 0.42}));
  EXPECT_EQ(found.brackets, 4U);
  ASSERT_FALSE(found.response.is_none());
  EXPECT_TRUE(is_monotonic(found.response));
  // Ratios of light between stored levels, within 2 %: EXIF's exposures are believed to 1 % a photo.
  const Response truth = s_curve(1.3, 0.42);
  for (const double s : {0.25, 0.4, 0.6, 0.75, 0.9})
    EXPECT_NEAR(light(found.response, s) - light(found.response, 0.5), light(truth, s) - light(truth, 0.5), 0.02) << s;
  EXPECT_LT(found.error_after, 0.3 * found.error_before);
  EXPECT_TRUE(found.findings.empty());
}

// Dark blocks are noisy, the shorter exposure's most: those that noise has brightened must not be chosen, nor may what
// is left of it bend the curve by as much as exposures of 1 % allow.
TEST(BracketResponse, NoiseInTheDarkDoesNotBendTheCurve) {
  const TemporaryFolder folder;
  Drawn phone{1.25, 0.42};
  phone.noise = 0.01;
  phone.grain = 4;
  const BracketResponse found = bracket_response(draw(folder, phone));
  const Response truth = s_curve(1.25, 0.42);
  for (const double s : {0.1, 0.2, 0.3, 0.7, 0.9})
    EXPECT_NEAR(light(found.response, s) - light(found.response, 0.5), light(truth, s) - light(truth, 0.5), 0.002) << s;
  EXPECT_TRUE(found.balance.empty());
}

// A curve that is told is believed; what brackets then disagree by is the photos' own.
TEST(BracketResponse, UnderACurveThatIsToldPhotosOfConstantExposureNeedNoBalance) {
  const TemporaryFolder folder;
  Session session = draw(folder, {1.3, 0.42});
  for (Photo& photo : session.photos) photo.response = s_curve(1.3, 0.42);
  const BracketResponse found = bracket_response(session, false);
  EXPECT_EQ(found.brackets, 4U);
  EXPECT_TRUE(found.response.is_none());
  EXPECT_TRUE(found.balance.empty());
  EXPECT_TRUE(found.findings.empty());
}

TEST(BracketResponse, APlainCameraHasNone) {
  const TemporaryFolder folder;
  const BracketResponse found = bracket_response(draw(folder, {}));
  EXPECT_EQ(found.brackets, 4U);
  EXPECT_TRUE(found.response.is_none());
  EXPECT_TRUE(found.balance.empty());
}

TEST(BracketResponse, NamesABracketThatContradictsItsExif) {
  const TemporaryFolder folder;
  const BracketResponse found = bracket_response(draw(folder, {1, 0.5, 1.5}));
  ASSERT_EQ(found.findings.size(), 1U);
  EXPECT_NE(found.findings[0].what.find("view v1 contradict"), std::string::npos) << found.findings[0].what;
  EXPECT_EQ(found.brackets, 3U);
  EXPECT_TRUE(found.response.is_none());
}

TEST(BracketResponse, SingleExposuresTellNothing) {
  const TemporaryFolder folder;
  const BracketResponse found = bracket_response(draw(folder, {1.3, 0.42, 1, 1}));
  EXPECT_EQ(found.brackets, 0U);
  EXPECT_TRUE(found.response.is_none());
}

}  // namespace
}  // namespace burin
