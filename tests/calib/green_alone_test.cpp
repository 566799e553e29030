// What is proved, on photos predicted from known grooves whose green lacks light where they are brightest: half the
// shift that is foretold is half of what a fit to green alone makes of the answer, and where all colors tell the same
// nothing moves.
// Not proved: how much of a glint's light JPEGs of a mosaic lose; scripts/random-benches --departures mosaic measures
// what comes of it.
#include "burin/calib/verdict/green_alone.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "burin/base/median.h"
#include "tests/calib/fitted_grooves.h"

namespace burin {
namespace {

// In color: green lacks `lost` of its light where the photo is brightest, less in proportion where it is not, red and
// blue have it, so that the mean is the photo's; and green is 1.1 times as bright as the mean everywhere.
constexpr float kGreenOfMean = 1.1F;
struct InColor {
  std::vector<MergedView> merged;
  std::vector<LightView> views;
};
Image green_alone(const Image& mean, float lost) {
  Image green = mean;
  const float brightest = *std::max_element(mean.data.begin(), mean.data.end());
  for (float& value : green.data) value *= 1 - lost * value / brightest;
  return green;
}
InColor in_color(const FittedGrooves& f, float lost) {
  InColor out;
  for (const PhotoData& photo : f.s.data.photos) {
    LightView& view = out.views.emplace_back(photo.photo);
    view.merged = out.merged.size();
    MergedView& merged = out.merged.emplace_back();
    merged.value = Image(f.s.bench.lens.width, f.s.bench.lens.height, 3);
    const Image green = green_alone(view.value, lost);
    for (int y = 0; y < view.window.height; ++y)
      for (int x = 0; x < view.window.width; ++x) {
        const int px = x + view.window.x0, py = y + view.window.y0;
        merged.value.at(px, py, 1) = kGreenOfMean * green.at(x, y);
        for (const int c : {0, 2})
          merged.value.at(px, py, c) = (3 * view.value.at(x, y) - merged.value.at(px, py, 1)) / 2;
      }
  }
  return out;
}

TEST(GreenAlone, ForetellsHalfOfWhatAFitToItMakes) {
  constexpr float kLost = 0.001F;  // less than a pixel's noise, so that the loss is nearly straight
  // One step, with the loss' curvature where that is not negative, is that much off.
  constexpr double kOfIt = 0.25;
  FittedGrooves f;
  fit_small_grooves(0, 1, f);
  solve(f.s.data, f.stage, 40, 1e-10, f.state, {}, "");
  const InColor colors = in_color(f, kLost);
  const Eigen::VectorXd half = half_shift_by_green_alone(colors.merged, colors.views, f.s.data, f.stage, f.state);

  State by_green = f.state;
  Problem data = f.s.data;
  for (PhotoData& photo : data.photos) {
    Image green = green_alone(photo.photo.value, kLost);
    std::vector<double> ratios;
    for (std::size_t i = 0; i < green.data.size(); ++i)
      if (photo.photo.valid[i]) ratios.push_back(photo.photo.value.data[i] / green.data[i]);
    const auto alike = static_cast<float>(median_of(std::move(ratios)));
    for (float& value : green.data) value *= alike;
    photo.photo.value = std::move(green);
  }
  solve(data, f.stage, 40, 1e-10, by_green, {}, "");
  const Eigen::VectorXd fitted = 0.5 * step_between(f.state, by_green);
  for (const int i : {unknown::log_alpha, unknown::log_depth, unknown::log_base_alpha})
    EXPECT_NEAR(half[i], fitted[i], kOfIt * std::abs(fitted[i])) << i;
  EXPECT_GT(std::abs(fitted[unknown::log_depth]), 3e-5);
}

TEST(GreenAlone, MovesNothingWhereColorsAgree) {
  FittedGrooves f;
  fit_small_grooves(0, 1, f);
  const InColor colors = in_color(f, 0);
  const Eigen::VectorXd half = half_shift_by_green_alone(colors.merged, colors.views, f.s.data, f.stage, f.state);
  for (const int i : {unknown::log_alpha, unknown::log_depth, unknown::log_base_alpha})
    EXPECT_LT(std::abs(half[i]), 1e-5);
}

}  // namespace
}  // namespace burin
