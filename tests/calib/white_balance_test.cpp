// Proves: a session under several lamps whose photos the camera balanced itself is told so, by EXIF alone; one lamp,
// raw files, photos in gray, a fixed balance and headers that say nothing are not.
#include "burin/calib/light/white_balance.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "tests/temporary_folder.h"

namespace burin {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class WhiteBalance : public testing::Test {
 protected:
  // A photo whose header says this of its balance (below 0: nothing).
  void add(const std::string& light, int balance, int channels = 3, Encoding encoding = Encoding::srgb) {
    Photo photo;
    photo.view = "front";
    photo.light = light;
    photo.encoding = encoding;
    photo.file = folder_ / (light + std::to_string(session_.photos.size()) + ".jpg");
    OIIO::ImageSpec spec(16, 8, channels, OIIO::TypeDesc::UINT8);
    if (balance >= 0) spec.attribute("Exif:WhiteBalance", balance);
    const auto out = OIIO::ImageOutput::create(photo.file.string());
    ASSERT_TRUE(out->open(photo.file.string(), spec));
    const std::vector<float> pixels(static_cast<std::size_t>(16 * 8 * channels), 0.5F);
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, pixels.data()));
    ASSERT_TRUE(out->close());
    session_.photos.push_back(photo);
  }
  TemporaryFolder folder_;
  Session session_;
};

TEST_F(WhiteBalance, TheCamerasOwnIsTold) {
  add("red", 1);
  add("green", 0);
  add("green", 0);
  const std::vector<Finding> said = check_white_balance(session_);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].severity, Finding::Severity::warning);
  EXPECT_THAT(said[0].what, AllOf(HasSubstr("2 of the 3 photos"), HasSubstr("green1.jpg")));
  EXPECT_THAT(said[0].remedy, HasSubstr("one fixed balance"));
}

TEST_F(WhiteBalance, WhatDoesNoHarmIsNot) {
  add("red", 1);
  add("green", -1);
  add("blue", 0, 1);
  add("blue", 0, 3, Encoding::raw);
  EXPECT_TRUE(check_white_balance(session_).empty());
  session_.photos.clear();
  for (int k = 0; k < 3; ++k) add("lamp", 0);  // one lamp: all that it makes differ is the board
  EXPECT_TRUE(check_white_balance(session_).empty());
}

}  // namespace
}  // namespace burin
