// Proves that a pixel weighs by the noise that is to be expected where it lies, not by what its own noise came out as:
// photos with the noise of counted photons, whose sigmas are read off their noisy values, are as bright on average as
// they are said to be.
#include "burin/calib/photo/photo_weights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/calib/small_grooves.h"

namespace burin {
namespace {

TEST(PhotoWeights, DarkPixelsDoNotWeighMoreForBeingDarkByChance) {
  SmallGrooves s;
  fill_small_grooves(s, 11);
  for (int k = 0; k < 6; ++k) s.data.photos.push_back(make_photo_data(add_view(s, k), 1, s.board, s.bench, 2));
  std::mt19937_64 random(5);
  std::vector<Image> shown;
  for (PhotoData& photo : s.data.photos) {
    shown.push_back(predict(s.data.model, photo, s.truth.of(0), carved_at(s.data.model, s.truth.of(0))));
    double mean = 0;
    for (const float v : shown.back().data)
      mean += static_cast<double>(v) / static_cast<double>(shown.back().data.size());
    const double photon = mean / 25, read2 = 4 * photon * photon;  // 25 photons where it is of the mean brightness
    for (std::size_t i = 0; i < photo.weight.size(); ++i) {
      if (!(photo.weight[i] > 0)) continue;
      const double expected = shown.back().data[i] / photon;
      const double value = photon * (std::poisson_distribution<int>(std::max(1e-9, expected))(random) +
                                     std::normal_distribution<double>(0, 2)(random));
      photo.photo.value.data[i] = static_cast<float>(value);
      photo.photo.sigma.data[i] = static_cast<float>(std::sqrt(photon * std::max(value, 0.0) + read2));
      photo.weight[i] = 1 / photo.photo.sigma.data[i];
    }
  }
  const auto darker = [&] {  // by how much photos seem darker than predicted, and the standard error of that
    double sum = 0, of = 0, variance = 0;
    for (std::size_t k = 0; k < shown.size(); ++k) {
      const PhotoData& photo = s.data.photos[k];
      for (std::size_t i = 0; i < photo.weight.size(); ++i) {
        const double w2 = photo.weight[i] * photo.weight[i], p = shown[k].data[i];
        if (!(w2 > 0)) continue;
        const double off = p - photo.photo.value.data[i];
        sum += w2 * p * off;
        variance += w2 * w2 * p * p * off * off;
        of += w2 * p * p;
      }
    }
    return std::pair{sum / of, std::sqrt(variance) / of};
  };
  const auto [by_own, by_own_error] = darker();
  EXPECT_GT(by_own, 10 * by_own_error) << "weighed by their own noise they seem too dark";
  weigh_photos(s.data, s.truth);
  const auto [off, error] = darker();
  EXPECT_LT(std::abs(off), 3 * error);
  EXPECT_LT(error, 0.1 * by_own);
}

}  // namespace
}  // namespace burin
