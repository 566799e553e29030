// burin/capture/tags/board_pose.h - where a camera stood, from the tags in one photo alone: good enough to say which
// photo it is (a few mm at a meter), not to measure with.
// Pixels: the center of the top-left pixel is (0, 0). Frames: board (mm), camera (x right, y down, z forward).
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vector>

#include "burin/capture/photo_look.h"
#include "burin/scene/board.h"
#include "burin/scene/lens.h"

namespace burin {

/// Corners of tags in a photo that lie where the board says, up to what a lens bends: point by point.
struct AgreeingCorners {
  std::vector<Eigen::Vector2d> board_mm, pixel;
  std::vector<int> id;     ///< of each point's tag
  std::vector<int> stray;  ///< ids of tags of which no corner lies where the board has it
};

/// `tolerance_px`: how far a corner may lie aside. Nothing agrees where fewer than two tags of the board are seen, but
/// for one tag alone if `one_is_enough`.
AgreeingCorners agreeing_corners(std::span<const TagLook> seen, const TagSet& tags, double tolerance_px,
                                 bool one_is_enough = false);

struct BoardPose {
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
  double error_px = 0;  ///< median distance of the corners from where this pose has them
};

/// The pose that fits best through that lens. Nothing where fewer than four corners agree, or no pose explains them.
std::optional<BoardPose> board_pose(const AgreeingCorners& corners, const Lens& lens);

/// Takes a tag out of `corners` (and into its `stray`) where that alone makes them fit: tags that lie at the corners of
/// a rectangle agree with each other wherever one of them is, but not with a lens that is known. Nothing changes with
/// fewer than three tags, or where all fit within `tolerance_px`.
void drop_stray_tag(AgreeingCorners& corners, const Lens& lens, double tolerance_px);

/// A lens without distortion, of that focal length, centered on the picture.
Lens plain_lens(double focal_px, int width, int height);

/// Focal lengths that a camera may have, in widths of its photos: from 0.3 to 10, each `step` (above 1) times the one
/// before.
std::vector<double> focal_scale(double step);

}  // namespace burin
