// Proves: pictures go to disk and back within their format's rounding, alpha lies over white, resizing keeps the mean,
// and files that are no pictures are named.
#include "burin/base/image.h"
#include "burin/pictures/picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "burin/base/error.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Image waves(int width, int height, int channels) {
  Image image(width, height, channels);
  for (std::size_t i = 0; i < image.data.size(); ++i)
    image.data[i] = 0.5f + 0.5f * std::sin(0.1f * static_cast<float>(i));
  return image;
}

float largest_difference(const Image& a, const Image& b) {
  float worst = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i) worst = std::max(worst, std::abs(a.data[i] - b.data[i]));
  return worst;
}

double mean(const Image& image) {
  return std::accumulate(image.data.begin(), image.data.end(), 0.0) / image.data.size();
}

TEST(Picture, RoundTripWithinTheFormatsRounding) {
  const TemporaryFolder folder;
  for (const int channels : {1, 3}) {
    const Image image = waves(37, 23, channels);
    const auto through = [&](const std::string& name, int bits) {
      write_picture(image, folder / name, bits);
      const Image back = read_picture(folder / name);
      EXPECT_EQ(back.width, 37);
      EXPECT_EQ(back.height, 23);
      EXPECT_EQ(back.channels, channels);
      return largest_difference(image, back);
    };
    EXPECT_LT(through("a.png", 8), 0.51f / 255);
    EXPECT_LT(through("b.png", 16), 0.51f / 65535);
    EXPECT_EQ(through("c.tif", 8), 0);
    EXPECT_EQ(through("d.exr", 8), 0);
  }
  const Image flat(16, 16, 3, 0.4f);
  write_picture(flat, folder / "e.jpg");
  EXPECT_LT(largest_difference(read_picture(folder / "e.jpg"), flat), 2.0f / 255);
  EXPECT_EQ(folder.file_count(), 5u);
}

TEST(Picture, ValuesBeyondTheRangeAreClampedInIntegerFormatsOnly) {
  const TemporaryFolder folder;
  Image image(2, 1, 1);
  image.data = {-0.5f, 7};
  write_picture(image, folder / "a.png");
  EXPECT_EQ(read_picture(folder / "a.png").data, (std::vector<float>{0, 1}));
  write_picture(image, folder / "a.exr");
  EXPECT_EQ(read_picture(folder / "a.exr").data, (std::vector<float>{-0.5f, 7}));
}

TEST(Picture, TransparencyLiesOverWhite) {
  // A PNG of three red pixels at 0, 50 and 100 %, byte by byte: writers multiply by alpha each in their own way.
  constexpr unsigned char kPng[] = {
      0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x00,
      0x03, 0x00, 0x00, 0x00, 0x01, 0x08, 0x06, 0x00, 0x00, 0x00, 0x1b, 0xe0, 0x14, 0xb4, 0x00, 0x00, 0x00, 0x12, 0x49,
      0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0xf8, 0xcf, 0xc0, 0xc0, 0x00, 0xc4, 0x0d, 0x40, 0xfc, 0x1f, 0x00, 0x1b, 0x74,
      0x04, 0x7d, 0xf9, 0x01, 0xa6, 0xf8, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  const TemporaryFolder folder;
  folder.write("a.png", std::string(std::begin(kPng), std::end(kPng)));
  const Image over_white = read_picture(folder / "a.png");
  ASSERT_EQ(over_white.channels, 3);
  const float half = 128.0f / 255;
  const std::vector<float> expected{1, 1, 1, 1, 1 - half, 1 - half, 1, 0, 0};
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(over_white.data[i], expected[i], 1.0 / 255) << i;
}

TEST(Picture, WhatIsNoPictureIsNamed) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { read_picture(folder / "none.png"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("none.png"), HasSubstr("does not exist"))));
  EXPECT_THAT([&] { read_picture(folder.write("text.png", "hello")); }, ThrowsMessage<Error>(HasSubstr("text.png")));
  EXPECT_THAT([&] { read_picture(folder.write("empty.jpg", "")); }, ThrowsMessage<Error>(HasSubstr("empty.jpg")));
  write_picture(waves(200, 200, 3), folder / "whole.png");
  const std::string whole = file_text(folder / "whole.png");
  // libpng has a line of its own for standard error: it is not to come to that.
  std::string flipped = whole;
  flipped[whole.find("IDAT") + 40] ^= 1;
  testing::internal::CaptureStderr();
  EXPECT_THAT([&] { read_picture(folder.write("cut.png", whole.substr(0, whole.size() / 2))); },
              ThrowsMessage<Error>(AllOf(HasSubstr("cut.png"), HasSubstr("is cut short"))));
  EXPECT_THAT([&] { read_picture(folder.write("flipped.png", flipped)); },
              ThrowsMessage<Error>(AllOf(HasSubstr("flipped.png"), HasSubstr("checksum"))));
  std::string head = whole, critical = whole;
  head[whole.find("IHDR") + 12] ^= 1;
  critical.replace(whole.find("IDAT"), 4, "ABCD");
  EXPECT_THAT([&] { read_picture(folder.write("head.png", head)); },
              ThrowsMessage<Error>(AllOf(HasSubstr("head.png"), HasSubstr("IHDR does not match its checksum"))));
  EXPECT_THAT([&] { read_picture(folder.write("critical.png", critical)); },
              ThrowsMessage<Error>(AllOf(HasSubstr("critical.png"), HasSubstr("ABCD does not belong there"))));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  write_picture(waves(200, 200, 3), folder / "whole.jpg");
  const std::string jpeg = file_text(folder / "whole.jpg");
  EXPECT_THAT([&] { read_picture(folder.write("cut.jpg", jpeg.substr(0, jpeg.size() * 3 / 4))); },
              ThrowsMessage<Error>(AllOf(HasSubstr("cut.jpg"), HasSubstr("cut short"))));
  EXPECT_THAT([&] { write_picture(waves(4, 4, 1), folder / "a.gif"); }, ThrowsMessage<Error>(HasSubstr(".gif")));
  EXPECT_THROW(write_picture(Image(), folder / "b.png"), Error);
  EXPECT_THROW(write_picture(waves(4, 4, 1), folder / "no/folder/b.png"), Error);
}

// Two rows of four pixels, 8 bits, compressed by runs: OpenImageIO 2.4 does not read it as other programs write it.
TEST(Picture, ABmpOfRunsIsReadOrNamed) {
  const TemporaryFolder folder;
  const auto number = [](std::uint32_t v, int bytes) {
    std::string out;
    for (int i = 0; i < bytes; ++i) out += static_cast<char>(v >> (8 * i) & 0xFFU);
    return out;
  };
  std::string palette;
  for (int i = 0; i < 256; ++i) palette += std::string(3, static_cast<char>(i)) + '\0';
  const std::string runs("\4\377\0\0\4\0\0\0\0\1", 10);  // four white, end of row, four black, end of row, end
  const std::uint32_t head = 14 + 40 + 1024;
  const std::string bmp = "BM" + number(head + 10, 4) + number(0, 4) + number(head, 4) + number(40, 4) + number(4, 4) +
                          number(2, 4) + number(1, 2) + number(8, 2) + number(1, 4) + number(10, 4) +
                          std::string(16, '\0') + palette + runs;
  try {
    const Image image = read_picture(folder.write("runs.bmp", bmp));
    EXPECT_NEAR(image.at(0, 1), 1, 1e-6);
    EXPECT_NEAR(image.at(0, 0), 0, 1e-6);
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("runs.bmp: is a BMP compressed by runs"), HasSubstr("save it as PNG")));
  }
}

TEST(Picture, ResizingKeepsMeanAndConstants) {
  const Image image = waves(64, 48, 3);
  for (const auto& [width, height] : {std::pair{32, 24}, {13, 7}, {64, 48}, {1, 1}}) {
    const Image small = resized(image, width, height);
    EXPECT_NEAR(mean(small), mean(image), 1e-5) << width;  // area weights: every source pixel counts alike
  }
  EXPECT_LT(largest_difference(resized(image, 64, 48), image), 1e-6f);
  for (const auto& [width, height] : {std::pair{200, 100}, {64, 20}, {5, 480}})
    EXPECT_LT(largest_difference(resized(Image(64, 48, 1, 0.25f), width, height), Image(width, height, 1, 0.25f)),
              1e-6f);
  // Twice as large, linear between centers: a ramp stays a ramp.
  Image ramp(8, 1, 1);
  for (int x = 0; x < 8; ++x) ramp.at(x, 0) = static_cast<float>(x);
  const Image wide = resized(ramp, 16, 1);
  for (int x = 1; x < 15; ++x) EXPECT_NEAR(wide.at(x, 0), 0.5f * static_cast<float>(x) - 0.25f, 1e-5f);
}

TEST(Picture, CurvesAreInverse) {
  for (const float v : {0.0f, 0.001f, 0.0031308f, 0.04f, 0.18f, 0.5f, 1.0f})
    EXPECT_NEAR(srgb_to_linear(linear_to_srgb(v)), v, 1e-6f);
  EXPECT_NEAR(linear_to_srgb(0.214041f), 0.5f, 1e-5f);  // IEC 61966-2-1: half of the code values is 21.4 % of the light
  Image image(1, 1, 3);
  image.data = {0, 1, 0};
  EXPECT_FLOAT_EQ(luminance(image).data[0], 0.7152f);
}

}  // namespace
}  // namespace burin
