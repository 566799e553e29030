// Proves: lamps that are not quite pure turn scratches away from their neighbors' pictures as pure ones do; a view's
// balance is that of its own pictures; what a scratch throws into another view counts there by that view's mask, in the
// sum of errors, in what strokes gain and in the kernel that places them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "burin/optimize/design/stroke_search.h"
#include "burin/optimize/loss/color_metrics.h"
#include "tests/optimize/color_rig.h"

namespace burin {
namespace {

class ColorSearch : public ColorRig {
 protected:
  // A second view in color from elsewhere, whose lamps stand close to the first's: its scratches show there.
  void add_view_beside() {
    View side = bench_.views[0];
    side.name = "side";
    const Eigen::Matrix3d R = side.T_camera_board.linear();
    side.T_camera_board.translation() = -R * Eigen::Vector3d(90, -100, 590);
    bench_.views.push_back(side);
    DesignView v = spec_.views[0];
    v.view = "side";
    std::swap(v.target.image, spec_.views[0].target.image);
    v.target.image = Image(64, 64, 3, 0.1F);
    for (int y = 30; y < 40; ++y)
      for (int x = 0; x < 64; ++x) v.target.image.at(x, y, 1) = 0.9F;
    spec_.views[0].target.image = discs(64);
    spec_.views.push_back(v);
  }
  // White left of the middle.
  static Image left_half() {
    Image mask(64, 64, 1);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 32; ++x) mask.at(x, y) = 1;
    return mask;
  }
  // A view with a mask beside one without: each picture's errors count where its own view says, whoever made the
  // stroke.
  void check_masks(bool masked_first) {
    set_apart(10);
    add_view_beside();
    spec_.views[masked_first ? 0 : 1].target.mask_image = left_half();
    const std::vector<WorkView> all = views();
    const std::vector<double> log_exposure = starting_exposures(all, 2, 0.5);
    std::vector<StrokeView> seen = stroke_views(all, log_exposure, true);
    const auto error = [&] {
      double sum = 0;
      std::vector<bool> counted(all.size(), false);
      const auto add = [&](int picture, const Image& light) {
        const auto p = static_cast<std::size_t>(picture);
        if (counted[p]) return;
        counted[p] = true;
        const WorkView& v = all[p];
        for (std::size_t i = 0; i < light.data.size(); ++i) {
          const double m = v.target.mask.data.empty() ? 1.0 : v.target.mask.data[i];
          const double shown = std::pow(std::clamp(static_cast<double>(light.data[i]), 0.0, 1.0), 1 / 2.2);
          sum += m * m * std::pow(shown - v.target.picture.data[i], 2) / 3;
        }
      };
      for (const StrokeView& v : seen) {
        add(v.picture, v.light);
        for (const StrokeAside& aside : v.asides) add(aside.picture, aside.light);
      }
      return sum;
    };
    const double by_hand = error();
    EXPECT_NEAR(squared_error(seen), by_hand, 5e-3 * by_hand);
    const CarvingLimits limits = design_limits(board_, bench_, options_);
    const std::vector<Stroke> strokes = place_strokes(seen, stroke_rules(limits, 4, bench_, board_, 16), 400, 5);
    ASSERT_GT(strokes.size(), 200U);
    double gains = 0;
    std::size_t right = 0;  // of the strokes for the view that has the mask, those where it says nothing
    for (const Stroke& s : strokes) {
      gains += s.gain;
      const bool of_masked = (all[static_cast<std::size_t>(seen[s.view].picture)].of == 0) == masked_first;
      right += of_masked && std::min(s.a_mm.x(), s.b_mm.x()) > 31 ? 1 : 0;
    }
    const double after = error();
    EXPECT_NEAR(by_hand - after, gains, 5e-3 * by_hand);
    EXPECT_NEAR(squared_error(seen), after, 5e-3 * by_hand);
    // They would only harm the other view.
    EXPECT_LT(right, strokes.size() / 50);
  }
};

TEST_F(ColorSearch, LampsOfAlmostOneColorAreTurnedAwayAsPureOnes) {
  set_apart(10);
  const double pure = design(spec_, board_, bench_, options_, {}).views.at(0).psnr_db;
  set_purity(0.98);
  const double nearly = design(spec_, board_, bench_, options_, {}).views.at(0).psnr_db;
  EXPECT_NEAR(nearly, pure, 0.5);
}

TEST_F(ColorSearch, APictureStandsOnceBesideALampWhetherItIsPureOrNot) {
  set_apart(10);
  set_purity(0.98);
  const std::vector<WorkView> all = views();
  const std::vector<StrokeView> seen = stroke_views(all, starting_exposures(all, 1, 0.5), true);
  ASSERT_EQ(seen.size(), 3U);
  for (const StrokeView& v : seen) {
    std::vector<int> pictures{v.picture};
    for (const StrokeAside& aside : v.asides) pictures.push_back(aside.picture);
    std::sort(pictures.begin(), pictures.end());
    EXPECT_EQ(pictures, (std::vector<int>{0, 1, 2}));
  }
  // Red throws a fiftieth of its own light into green's picture and a fifth of green's: it is green's that counts.
  const auto aside =
      std::find_if(seen[0].asides.begin(), seen[0].asides.end(), [](const StrokeAside& a) { return a.picture == 1; });
  ASSERT_NE(aside, seen[0].asides.end());
  EXPECT_NEAR((aside->glint.light_mm - bench_.lights[1].position_mm).norm(), 0, 1e-9);
  // Far apart nothing is shared but its own light.
  set_apart(60);
  const std::vector<WorkView> apart = views();
  for (const StrokeView& v : stroke_views(apart, starting_exposures(apart, 1, 0.5), true))
    for (const StrokeAside& own : v.asides) EXPECT_NEAR((own.glint.light_mm - v.glint.light_mm).norm(), 0, 1e-9);
}

TEST_F(ColorSearch, BalanceIsThatOfAViewsOwnPictures) {
  set_apart(10);
  add_view_beside();
  std::vector<WorkView> all = views();
  render_all(all, Carved{});
  ASSERT_TRUE(std::any_of(all.begin(), all.end(), [](const WorkView& v) {
    return std::any_of(v.lamps.begin(), v.lamps.end(), [](const WorkLamp& lamp) { return !lamp.ghosts.empty(); });
  }));
  const std::vector<double> log_exposure = starting_exposures(all, 2, 0.5);
  balance_views(all, log_exposure, 0.5);
  // By hand: each picture's error under its own exposure.
  std::vector<double> error(2, 0.0);
  for (const WorkView& v : all) {
    Image light = v.radiance;
    for (float& l : light.data)
      l *= static_cast<float>(std::exp(log_exposure[static_cast<std::size_t>(v.exposure_group)]));
    const Image picture = shown_picture(light, 1);
    for (std::size_t i = 0; i < picture.data.size(); ++i)
      error[v.of] += std::pow(static_cast<double>(picture.data[i]) - v.target.picture.data[i], 2) / 3;
  }
  ASSERT_GT(std::abs(std::log(error[0] / error[1])), 0.2);  // they differ
  EXPECT_NEAR(all[0].balance / all[3].balance, std::sqrt(error[0] / error[1]), 0.01 * all[0].balance / all[3].balance);
}

TEST_F(ColorSearch, WhatMattersOfAPictureIsWhatItsOwnViewSays) { check_masks(true); }

TEST_F(ColorSearch, ThatMayBeTheSecondViews) { check_masks(false); }

}  // namespace
}  // namespace burin
