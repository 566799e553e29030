// Footprint corners project back onto the pixel corners they came from, through the lens library's own projection, for
// flat and bowed faces; the homography agrees where there is one; misses are NaN. Not proved here: the lens model
// itself (lens_test).
#include "burin/scene/footprint_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "burin/base/error.h"

namespace burin {
namespace {

Lens rig_lens() {
  Lens lens;
  lens.width = 1400;
  lens.height = 1050;
  lens.intrinsics = {2104.3, 2103.1, 703.7, 521.2, -0.083, 0.071, 0.0006, -0.0004, 0.01, 0, 0, 0};
  return lens;
}

Eigen::Isometry3d tilted_pose() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = (Eigen::AngleAxisd(std::numbers::pi - 0.6, Eigen::Vector3d::UnitX()) *
                Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()))
                   .toRotationMatrix();
  T.translation() = Eigen::Vector3d(0, 0, 900) - T.linear() * Eigen::Vector3d(150, 150, 0);
  return T;
}

void expect_round_trip(const Lens& lens, const Surface& surface, const PixelWindow& window) {
  const Eigen::Isometry3d T = tilted_pose();
  const FootprintGrid grid = camera_grid(lens, T, surface, window);
  std::vector<Eigen::Vector3d> p;
  std::vector<Eigen::Vector2d> expected_px;
  for (int r = 0; r <= window.height; ++r) {
    for (int c = 0; c <= window.width; ++c) {
      const std::size_t i = static_cast<std::size_t>(r) * (window.width + 1) + c;
      const double x = grid.corner_x_mm[i], y = grid.corner_y_mm[i];
      if (std::isnan(x)) continue;
      p.push_back(T * Eigen::Vector3d(x, y, height_mm(surface, x, y)));
      expected_px.emplace_back(window.x0 + c - 0.5, window.y0 + r - 0.5);
    }
  }
  ASSERT_GT(p.size(), 1000u);
  std::vector<Eigen::Vector2d> q(p.size());
  project(lens, p, q);
  double worst = 0;
  for (std::size_t i = 0; i < p.size(); ++i) worst = std::max(worst, (q[i] - expected_px[i]).norm());
  EXPECT_LT(worst, 1e-9) << "px";
}

TEST(CameraGrid, CornersProjectBack) {
  const Surface flat{{300, 300}, {0, 0, 0}}, bowed{{300, 300}, {0.8, -0.5, 1.1}};
  for (const Surface& s : {flat, bowed}) expect_round_trip(rig_lens(), s, {0, 0, 1400, 1050});
  expect_round_trip(rig_lens(), bowed, {333, 207, 111, 222});
}

TEST(CameraGrid, HomographyOnlyForAPlainView) {
  Lens lens = rig_lens();
  const Surface flat{{300, 300}, {0, 0, 0}}, bowed{{300, 300}, {0.8, -0.5, 1.1}};
  EXPECT_FALSE(camera_grid(lens, tilted_pose(), flat, {500, 400, 9, 9}).board_from_pixel.has_value());
  std::fill(lens.intrinsics.begin() + 4, lens.intrinsics.end(), 0);
  EXPECT_FALSE(camera_grid(lens, tilted_pose(), bowed, {500, 400, 9, 9}).board_from_pixel.has_value());
  const FootprintGrid grid = camera_grid(lens, tilted_pose(), flat, {500, 400, 9, 9});
  ASSERT_TRUE(grid.board_from_pixel.has_value());
  for (int r = 0; r <= 9; ++r) {
    for (int c = 0; c <= 9; ++c) {
      const Eigen::Vector2d p = (*grid.board_from_pixel * Eigen::Vector3d(c - 0.5, r - 0.5, 1)).hnormalized();
      EXPECT_NEAR(p.x(), grid.corner_x_mm[r * 10 + c], 1e-9);
      EXPECT_NEAR(p.y(), grid.corner_y_mm[r * 10 + c], 1e-9);
    }
  }
}

TEST(CameraGrid, CentersAndNormalsLieOnTheFace) {
  const Surface bowed{{300, 300}, {0.8, -0.5, 1.1}};
  const FootprintGrid grid = camera_grid(rig_lens(), tilted_pose(), bowed, {500, 400, 50, 50});
  for (std::size_t i = 0; i < grid.center_mm.size(); ++i) {
    const Eigen::Vector3d& p = grid.center_mm[i];
    EXPECT_NEAR(p.z(), height_mm(bowed, p.x(), p.y()), 1e-12);
    EXPECT_NEAR(grid.normal[i].norm(), 1, 1e-12);
    EXPECT_NEAR((grid.normal[i] - face_normal(bowed, p.x(), p.y())).norm(), 0, 1e-12);
  }
}

TEST(CameraGrid, MissesAreNaN) {
  const Surface small{{30, 30}, {0, 0, 0}};
  const FootprintGrid grid = camera_grid(rig_lens(), tilted_pose(), small, {0, 0, 1400, 1050});
  std::size_t hits = 0;
  for (const double x : grid.corner_x_mm) hits += !std::isnan(x);
  EXPECT_LT(hits, grid.corner_x_mm.size() / 2);
  // From behind the board: nothing of the face is seen.
  Eigen::Isometry3d behind = tilted_pose();
  behind = behind * Eigen::Translation3d(0, 0, 2000);
  for (const double x : camera_grid(rig_lens(), behind, small, {0, 0, 14, 10}).corner_x_mm) EXPECT_TRUE(std::isnan(x));
}

TEST(CameraGrid, BadInputIsNamed) {
  EXPECT_THROW(camera_grid(rig_lens(), tilted_pose(), {{300, 300}, {0, 0, 0}}, {0, 0, 0, 5}), Error);
  EXPECT_THROW(camera_grid(rig_lens(), tilted_pose(), {{0, 300}, {0, 0, 0}}, {0, 0, 5, 5}), Error);
  EXPECT_THROW(board_grid({5, 5}, {5, 9}, 4, 4, {{300, 300}, {0, 0, 0}}), Error);
}

TEST(BoardGrid, RectanglesFromTheTop) {
  const FootprintGrid grid = board_grid({10, 20}, {50, 80}, 4, 3, {{300, 300}, {0, 0, 0}});
  const auto q = footprint_corners_mm(grid, 0, 0);
  EXPECT_EQ(q[0], Eigen::Vector2d(10, 80));
  EXPECT_EQ(q[2], Eigen::Vector2d(20, 60));
  EXPECT_EQ(footprint_corners_mm(grid, 3, 2)[2], Eigen::Vector2d(50, 20));
  EXPECT_LT((*grid.board_from_pixel * Eigen::Vector3d(-0.5, -0.5, 1) - Eigen::Vector3d(10, 80, 1)).norm(), 1e-12);
}

TEST(WindowOf, HoldsTheRectangleAndNoMore) {
  const Surface surface{{300, 300}, {0.8, -0.5, 1.1}};
  const Eigen::Isometry3d T = tilted_pose();
  const PixelWindow w = window_of(rig_lens(), T, surface, {100, 100}, {200, 180}, 0);
  double x0 = 1e9, x1 = -1e9, y0 = 1e9, y1 = -1e9;
  for (int j = 0; j <= 300; ++j) {
    for (int i = 0; i <= 300; ++i) {
      const double x = 100 + 100.0 * i / 300, y = 100 + 80.0 * j / 300;
      const std::array<Eigen::Vector3d, 1> p{T * Eigen::Vector3d(x, y, height_mm(surface, x, y))};
      std::array<Eigen::Vector2d, 1> q;
      project(rig_lens(), p, q);
      x0 = std::min(x0, q[0].x());
      x1 = std::max(x1, q[0].x());
      y0 = std::min(y0, q[0].y());
      y1 = std::max(y1, q[0].y());
    }
  }
  EXPECT_LE(w.x0 - 0.5, x0);
  EXPECT_GE(w.x0 + w.width - 0.5, x1);
  EXPECT_LE(w.y0 - 0.5, y0);
  EXPECT_GE(w.y0 + w.height - 0.5, y1);
  EXPECT_NEAR(w.width, x1 - x0, 2);
  EXPECT_NEAR(w.height, y1 - y0, 2);
  EXPECT_EQ(window_of(rig_lens(), T, surface, {-9000, 0}, {-8000, 100}, 0).width, 0);
}

}  // namespace
}  // namespace burin
