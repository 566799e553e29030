// burin/capture/tags/board_pose.h - camera pose from the tags in one photo alone. The accuracy of a few mm at a meter
// identifies a photo; it does not suffice for measurements. Pixels: the center of the top-left pixel is (0, 0). Frames:
// board (mm), camera (x right, y down, z forward).
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vector>

#include "burin/capture/photo_look.h"
#include "burin/scene/board.h"
#include "burin/scene/lens.h"

namespace burin {

/// Corners of tags in a photo at their places on the board, up to lens distortion; one entry per point.
struct AgreeingCorners {
  std::vector<Eigen::Vector2d> board_mm, pixel;
  std::vector<int> id;     ///< tag of each point
  std::vector<int> stray;  ///< ids of tags with no corner at the board's place
};

/// `tolerance_px` is the largest deviation of a corner. Nothing agrees if fewer than two tags of the board are seen;
/// `one_is_enough` permits a single tag.
AgreeingCorners agreeing_corners(std::span<const TagLook> seen, const TagSet& tags, double tolerance_px,
                                 bool one_is_enough = false);

/// Pose of the board in a photo, from its tags.
struct BoardPose {
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
  double error_px = 0;  ///< median distance of the corners from their places under this pose
};

/// The best pose through that lens. Nothing if fewer than four corners agree, or if no pose explains them.
std::optional<BoardPose> board_pose(const AgreeingCorners& corners, const Lens& lens);

/// Moves a tag from `corners` to its `stray` if this alone makes the corners fit. Tags at the corners of a rectangle
/// agree with each other wherever one of them is, but not with a known lens. Nothing changes with fewer than three
/// tags, or if all fit within `tolerance_px`.
void drop_stray_tag(AgreeingCorners& corners, const Lens& lens, double tolerance_px);

/// A lens without distortion, with that focal length, centered on the picture.
Lens plain_lens(double focal_px, int width, int height);

/// Focal lengths of possible cameras, in widths of their photos: from 0.3 to 10, each `step` (above 1) times the
/// previous one.
std::vector<double> focal_scale(double step);

}  // namespace burin
