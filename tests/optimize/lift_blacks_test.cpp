// Proves that pictures in a room are asked for in tones that the room allows: they come out more like what was wanted
// (by correlation, which no lift of all tones changes), are judged by what was wanted, and lamps' pictures stay as they
// are.
#include "burin/optimize/design/lift_blacks.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "burin/optimize/design.h"
#include "burin/optimize/loss/picture_metrics.h"
#include "burin/scene/far_light.h"
#include "burin/scene/look_at.h"

namespace burin {
namespace {

using testing::Contains;
using testing::Each;
using testing::Field;
using testing::HasSubstr;
using testing::Not;

TEST(BlackFor, IsNothingWhereScratchesCanBeDarkAndGrowsAsTheyCannot) {
  EXPECT_EQ(black_for(1000), 0);
  EXPECT_EQ(black_for(28), 0);
  EXPECT_GT(black_for(10), 0.05);
  EXPECT_GT(black_for(5), black_for(10));
  EXPECT_GT(black_for(1), black_for(5));
  EXPECT_LT(black_for(1), 0.7);  // even where nothing could be seen
}

class LiftBlacks : public testing::Test {
 protected:
  void SetUp() override {
    Image disc(64, 64, 1, 0.001F), ramp(64, 64, 1);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        const double from_middle = std::hypot(x - 31.5, y - 31.5);
        if (from_middle < 26) disc.at(x, y) = from_middle < 14 ? 0.9F : 0.12F;
        ramp.at(x, y) = x > 40 && x < 50 ? 0.9F : 0.3F * static_cast<float>(y) / 63;
      }
    board_.size_mm = {60, 60};
    board_.carve_min_mm = {5, 5};
    board_.carve_max_mm = {55, 55};
    board_.tool_width_um = 400;
    board_.material.alpha = 0.06;
    board_.material.depth_um = 14;
    bench_.material = board_.material;
    bench_.material.base_alpha = 0.15;
    const Eigen::Vector3d middle(30, 30, 0);
    for (const double x : {-120.0, 180.0}) {
      View view;
      view.name = x < 0 ? "left" : "right";
      view.T_camera_board = look_at({x, -50, 520}, middle);
      bench_.views.push_back(view);
    }
    spec_.scratches = 900;
    spec_.views = {{"left", "lamp", {}, 1}, {"right", "lamp", {}, 1}};
    spec_.views[0].target.image = disc;
    spec_.views[1].target.image = ramp;
    options_.pixels = 64;
    options_.iterations = 30;
    lamp_.position_mm = {30, 460, 560};
    lamp_.intensity.setConstant(1e6);
  }

  // Walls, and a window where the lamp is.
  Light room() const {
    Image picture(256, 128, 3, 0.15F);
    const auto frame = make_panorama(picture, {}, "room");
    const Eigen::Vector3d window = (lamp_.position_mm - Eigen::Vector3d(30, 30, 0)).normalized();
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x)
        if (frame->direction(x + 0.5, y + 0.5).dot(window) > std::cos(10 * std::numbers::pi / 180))
          for (int c = 0; c < 3; ++c) picture.at(x, y, c) = 8;
    Light out = surroundings_light(make_panorama(picture, {}, "room"));
    out.id = "lamp";
    return out;
  }

  DesignResult designed(const Light& light, double lift) {
    bench_.lights = {light};
    options_.lift_blacks = lift;
    return design(spec_, board_, bench_, options_, {});
  }

  Board board_;
  Bench bench_;
  DesignSpec spec_;
  DesignOptions options_;
  Light lamp_;
};

TEST_F(LiftBlacks, InARoomPicturesComeOutMoreLikeWhatWasWanted) {
  const DesignResult lifted = designed(room(), 1), as_asked = designed(room(), 0);
  const auto told = Contains(Field(&Finding::what, HasSubstr("black was taken for")));
  EXPECT_THAT(lifted.findings, told);
  EXPECT_THAT(as_asked.findings, Not(told));
  double gained = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(lifted.views[k].target.data, as_asked.views[k].target.data);  // what they are judged by
    gained += correlation(lifted.views[k].shown, lifted.views[k].target) -
              correlation(as_asked.views[k].shown, as_asked.views[k].target);
    EXPECT_GT(lifted.views[k].psnr_db, as_asked.views[k].psnr_db - 1.5);
  }
  EXPECT_GT(gained, 0.01);
}

TEST_F(LiftBlacks, UnderALampNothingIsLifted) {
  const DesignResult one = designed(lamp_, 1), other = designed(lamp_, 0);
  EXPECT_EQ(one.scratches.x0_mm, other.scratches.x0_mm);
  EXPECT_THAT(one.findings, Each(Field(&Finding::what, Not(HasSubstr("black was taken for")))));
}

}  // namespace
}  // namespace burin
