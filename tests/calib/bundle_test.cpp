// Proves: a camera that moves the edges of bright and dark in its pictures, as sharpening does, moves no camera: the
// sides of tags lie further out there by one number of pixels, beside the millimeters by which they were printed
// larger.
#include "burin/calib/geometry/bundle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "burin/scene/board.h"
#include "burin/scene/lens.h"

namespace burin {
namespace {

constexpr double kFocal_px = 2400;

// The meeting point of the lines through a, b and through b, c, each moved aside by `by_px`, away from the tag's
// middle.
Eigen::Vector2d moved_corner(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                             const Eigen::Vector2d& middle, double by_px) {
  Eigen::Matrix2d normals;
  Eigen::Vector2d at;
  int row = 0;
  for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c)}) {
    Eigen::Vector2d normal(q.y() - p.y(), p.x() - q.x());
    normal.normalize();
    if (normal.dot(p - middle) < 0) normal = -normal;
    normals.row(row) = normal.transpose();
    at[row++] = normal.dot(p) + by_px;
  }
  return normals.inverse() * at;
}

// Sixteen tags along the rim of a board of 110 mm, seen from seven places, leaning by up to 45 degrees.
Bundle photographed(double spread_px) {
  Bundle b;
  b.lens = plain_lens("LENSMODEL_OPENCV4", kFocal_px, 960, 740);
  b.surface.size_mm = {110, 110};
  std::vector<Tag> tags;
  for (const double y : {10., 32.5, 55., 77.5, 100.})
    for (const double x : {10., 32.5, 55., 77.5, 100.})
      if (x == 10 || x == 100 || y == 10 || y == 100) {
        Tag tag;
        tag.center_mm = {x, y};
        tag.size_mm = 10;
        tags.push_back(tag);
        TagPlacement placement;
        placement.sigma_mm = 0.05;
        placement.sigma_rad = 0.01;
        b.tags.push_back(placement);
      }
  for (const auto& [along, across] :
       {std::pair(0., 0.), {0.6, 0.}, {-0.5, 0.4}, {0., 0.7}, {0.3, -0.6}, {-0.7, 0.}, {0.4, 0.5}}) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() =
        (Eigen::AngleAxisd(along, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(across, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(std::acos(-1.0), Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    T.translation() = Eigen::Vector3d(0, 0, 450) - T.linear() * Eigen::Vector3d(55, 55, 0);
    b.views.push_back(T);
  }
  for (std::size_t v = 0; v < b.views.size(); ++v)
    for (std::size_t t = 0; t < tags.size(); ++t) {
      std::array<BundleCorner, 4> corners;
      std::array<Eigen::Vector3d, 4> p;
      std::array<Eigen::Vector2d, 4> q;
      for (std::size_t k = 0; k < 4; ++k) {
        corners[k].view = static_cast<int>(v);
        corners[k].tag = static_cast<int>(t);
        corners[k].center_mm = tags[t].center_mm;
        corners[k].offset_mm = tag_corners_mm(tags[t])[k] - tags[t].center_mm;
        corners[k].sigma_px = 0.03;
        p[k] = b.views[v] * bundle_point_mm(b, corners[k]);
      }
      project(b.lens, p, q);
      const Eigen::Vector2d middle = 0.25 * (q[0] + q[1] + q[2] + q[3]);
      std::array<Eigen::Vector2d, 4> seen;
      for (std::size_t k = 0; k < 4; ++k)
        seen[k] = moved_corner(q[(k + 3) % 4], q[k], q[(k + 1) % 4], middle, spread_px);
      const auto outward = outward_px(seen);
      for (std::size_t k = 0; k < 4; ++k) {
        corners[k].q_px = seen[k];
        corners[k].outward = outward[k];
        b.corners.push_back(corners[k]);
      }
    }
  return b;
}

TEST(Bundle, EdgesThatMoveInPicturesMoveNoCamera) {
  constexpr double kSpread_px = 0.1;
  const Bundle exact = photographed(0);
  const auto worst_center_mm = [&](const Bundle& b) {
    double worst = 0;
    for (std::size_t v = 0; v < b.views.size(); ++v)
      worst = std::max(worst, (b.views[v].inverse().translation() - exact.views[v].inverse().translation()).norm());
    return worst;
  };
  Bundle b = photographed(kSpread_px), as_print = b;
  solve_bundle(b, {});
  EXPECT_NEAR(b.spread_px, kSpread_px, 0.01 * kSpread_px);
  EXPECT_NEAR(b.edge_mm, 0, 1e-4);
  EXPECT_NEAR(b.lens.intrinsics[0] / kFocal_px, 1, 2e-5);
  EXPECT_LT(worst_center_mm(b), 0.01);
  // Taken for larger tags, it is not harmless.
  BundleOptions no_spread;
  no_spread.spread_prior_px = 1e-9;
  solve_bundle(as_print, no_spread);
  EXPECT_GT(worst_center_mm(as_print), 0.05);
}

}  // namespace
}  // namespace burin
