// Proves: the pixels that measured green are recognized in photos whose other colors were made up by OpenCV's
// edge-aware demosaicing (as PNG, as JPEG with halved colors, shifted by a pixel), and nowhere else; glints keep their
// light where those pixels alone serve, and lose it where they do not.
#include "burin/capture/green_sites.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "burin/capture/photo.h"
#include "burin/pictures/picture.h"
#include "burin/simulate/camera_truth.h"
#include "tests/temporary_folder.h"

namespace burin {
namespace {

constexpr int kSize = 320;

// Dim metal with sparse glints, a pixel and less wide, gray.
Image glints(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> anywhere(2, kSize - 3), brightness(0.5F, 4);
  cv::Mat light(kSize, kSize, CV_32F, cv::Scalar(0.012));
  for (int i = 0; i < 1500; ++i)
    light.at<float>(static_cast<int>(anywhere(random)), static_cast<int>(anywhere(random))) += brightness(random);
  cv::GaussianBlur(light, light, cv::Size(), 0.75);
  std::normal_distribution<float> noise(0, 0.002F);
  Image out(kSize, kSize, 3);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const float v = std::clamp(0.7F * light.at<float>(y, x), 0.0F, 0.9F);
      for (int c = 0; c < 3; ++c) out.at(x, y, c) = std::clamp(v + noise(random), 0.0F, 1.0F);
    }
  return out;
}

struct Stored {
  bool mosaic = true;
  const char* file = "photo.png";
  int from_column = 0;  // columns left of it are cut off
};

Photo photographed(const Image& linear, const Stored& how, const TemporaryFolder& folder) {
  CameraTruth camera;
  camera.mosaic = how.mosaic;
  const Image stored = developed(linear, Encoding::srgb, camera, 1);
  Image kept(stored.width - how.from_column, stored.height, 3);
  for (int y = 0; y < kept.height; ++y)
    for (int x = 0; x < kept.width; ++x)
      for (int c = 0; c < 3; ++c) kept.at(x, y, c) = stored.at(x + how.from_column, y, c);
  Photo photo;
  photo.file = folder / how.file;
  photo.encoding = Encoding::srgb;
  photo.exposure_s = photo.f_number = 1;
  write_picture(kept, photo.file);
  return photo;
}

double mean_of(const Image& image) {
  return std::accumulate(image.data.begin(), image.data.end(), 0.0) / static_cast<double>(image.data.size());
}

TEST(GreenSites, AreRecognizedWhereColorsWereMadeUp) {
  const TemporaryFolder folder;
  const Image light = glints(3);
  const auto found = [&](const Stored& how) {
    const std::vector<Photo> photos{photographed(light, how, folder)};
    return find_green_sites(photos).sites;
  };
  EXPECT_EQ(found({true, "photo.png", 0}), GreenSites::odd);  // R G / G B
  EXPECT_EQ(found({true, "photo.jpg", 0}), GreenSites::odd);
  EXPECT_EQ(found({true, "photo.jpg", 1}), GreenSites::even);
  EXPECT_EQ(found({false, "photo.png", 0}), GreenSites::unknown);
  EXPECT_EQ(found({false, "photo.jpg", 0}), GreenSites::unknown);
}

TEST(GreenSites, AreNotSoughtInRawFilesOrInNothing) {
  const TemporaryFolder folder;
  std::vector<Photo> photos{photographed(glints(3), {}, folder)};
  photos[0].encoding = Encoding::raw;
  EXPECT_EQ(find_green_sites(photos).sites, GreenSites::unknown);
  EXPECT_EQ(find_green_sites({}).sites, GreenSites::unknown);
}

TEST(GreenSites, GlintsKeepTheirLightWhereTheseAloneServe) {
  const TemporaryFolder folder;
  const Image light = glints(5);
  const double truth = mean_of(light);
  for (const char* file : {"photo.png", "photo.jpg"}) {
    Photo photo = photographed(light, {true, file, 0}, folder);
    const double as_made_up = mean_of(merge_bracket({&photo, 1}).value) / truth - 1;
    photo.green_sites = GreenSites::odd;
    const double as_measured = mean_of(merge_bracket({&photo, 1}).value) / truth - 1;
    MergeOptions binned;
    binned.bin = 2;
    const double of_bins = mean_of(merge_bracket({&photo, 1}, {}, binned).value) / truth - 1;
    EXPECT_LT(as_made_up, -0.015) << file;
    EXPECT_LT(std::abs(as_measured), 0.4 * std::abs(as_made_up)) << file << " " << as_measured;
    EXPECT_LT(std::abs(of_bins), 0.4 * std::abs(as_made_up)) << file << " " << of_bins;
  }
}

}  // namespace
}  // namespace burin
