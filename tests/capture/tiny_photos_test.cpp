// Proves: pictures of any size, down to one pixel, are searched for tags without reading past them: nothing is found.
#include <gtest/gtest.h>

#include <random>

#include "burin/capture/tags/tag_detector.h"

namespace burin {
namespace {

TEST(TinyPhotos, HoldNoTags) {
  TagDetector detector("tag36h11");
  std::mt19937 random(1);
  std::uniform_real_distribution<float> value(0, 1);
  std::vector<std::pair<int, int>> sizes{{5000, 1}, {1, 5000}, {5000, 2}, {3, 5000}, {40, 15}, {15, 40}, {17, 40}};
  for (int w = 1; w <= 18; ++w)
    for (int h = 1; h <= 18; ++h) sizes.emplace_back(w, h);
  for (const auto& [w, h] : sizes) {
    Image image(w, h, 1);
    for (float& v : image.data) v = value(random);
    EXPECT_TRUE(detector.detect(image, {}, {}).tags.empty()) << w << " x " << h;
    EXPECT_TRUE(detector.detect_coarse(image).empty()) << w << " x " << h;
  }
}

}  // namespace
}  // namespace burin
