// The way of an animation through its places, and that its file is an animated PNG: every chunk's checksum, frames
// counted and numbered in one row, sizes alike; what is no frame is refused.
#include "tools/animate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "burin/base/error.h"
#include "tools/animated_png.h"

namespace burin {
namespace {

TEST(Animate, WalksEvenlyThroughAllPlaces) {
  const Eigen::Vector3d middle(60, 60, 0);
  const std::array<Eigen::Vector3d, 3> places{middle + Eigen::Vector3d(-300, 0, 520),
                                              middle + Eigen::Vector3d(0, 0, 800),
                                              middle + Eigen::Vector3d(400, 0, 400)};
  const std::vector<Step> steps = walk_through(places, middle, 31);
  ASSERT_EQ(steps.size(), 31U);
  EXPECT_LT((steps.front().position_mm - places[0]).norm(), 1e-9);
  EXPECT_LT((steps.back().position_mm - places[2]).norm(), 1e-9);
  double nearest = 1e9, first = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    nearest = std::min(nearest, (steps[i].position_mm - places[1]).norm());
    if (i == 0) continue;
    const Eigen::Vector3d a = (steps[i - 1].position_mm - middle).normalized(),
                          b = (steps[i].position_mm - middle).normalized();
    const double turn = std::atan2(a.cross(b).norm(), a.dot(b));
    if (i == 1) first = turn;
    EXPECT_NEAR(turn, first, 1e-6);
  }
  EXPECT_LT(nearest, 30);  // half a step at most
  EXPECT_EQ(walk_through({places.data(), 1}, middle, 31).size(), 1U);
}

std::string chunk(const std::string& type, const std::string& data) {
  std::string out;
  for (int i = 3; i >= 0; --i) out.push_back(static_cast<char>(data.size() >> (8 * i)));
  return out + type + data + std::string(4, '\0');  // readers of frames do not look at checksums
}

std::string frame(char width, const std::string& pixels) {
  const std::string size{0, 0, 0, width, 0, 0, 0, 1};
  return std::string("\x89PNG\r\n\x1a\n", 8) + chunk("IHDR", size + std::string("\x08\x00\x00\x00\x00", 5)) +
         chunk("IDAT", pixels) + chunk("IEND", "");
}

// The checksum of PNG, bit by bit.
std::uint32_t checksum(const std::string& bytes) {
  std::uint32_t c = 0xffffffffU;
  for (const char byte : bytes) {
    c ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) c = (c & 1U) != 0 ? (c >> 1) ^ 0xedb88320U : c >> 1;
  }
  return ~c;
}

std::uint32_t number(const std::string& bytes, std::size_t at) {
  std::uint32_t v = 0;
  for (std::size_t i = 0; i < 4; ++i) v = (v << 8) | static_cast<unsigned char>(bytes[at + i]);
  return v;
}

TEST(Animate, WritesAnAnimatedPng) {
  const std::string png = animated_png({frame(7, "first"), frame(7, "second"), frame(7, "third")}, 8);
  std::vector<std::string> types;
  std::uint32_t expected = 0;
  for (std::size_t at = 8; at < png.size();) {
    const std::uint32_t length = number(png, at);
    const std::string type = png.substr(at + 4, 4), data = png.substr(at + 8, length);
    ASSERT_EQ(number(png, at + 8 + length), checksum(type + data)) << type;
    if (type == "acTL") {
      EXPECT_EQ(number(data, 0), 3U);
    }
    if (type == "fcTL" || type == "fdAT") {
      EXPECT_EQ(number(data, 0), expected++) << type;
    }
    if (type == "fcTL") {
      EXPECT_EQ(number(data, 4), 7U);
      EXPECT_EQ(number(data, 20), (125U << 16) | 1000U);  // an eighth of a second
    }
    types.push_back(type);
    at += 12 + length;
  }
  EXPECT_THAT(types, testing::ElementsAre("IHDR", "acTL", "fcTL", "IDAT", "fcTL", "fdAT", "fcTL", "fdAT", "IEND"));
  EXPECT_THROW(animated_png({}, 8), Error);
  EXPECT_THROW(animated_png({"no picture"}, 8), Error);
  EXPECT_THROW(animated_png({frame(7, "a"), frame(8, "b")}, 8), Error);
}

}  // namespace
}  // namespace burin
