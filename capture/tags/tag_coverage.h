// burin/capture/tags/tag_coverage.h - statistics of the tags in a session's photos before any solve: their sizes, the
// viewing directions, and the agreement of all photos with one lens. Pixels: the center of the top-left pixel is (0,
// 0). Frames: board (mm), camera.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "burin/capture/photo_look.h"
#include "burin/scene/board.h"

namespace burin {

/// Tags of one photo.
struct TagView {
  int tags = 0;
  double side_px = 0;  ///< median side; 0 without tags
  /// The board's normal in the camera's frame, and the pose's error at the tags (median, px), for the session's shared
  /// focal length. None if fewer than four points agree with board.json.
  std::optional<Eigen::Vector3d> normal;
  double error_px = 0;
  /// The best focal length for this photo alone, and its error; valid if the board is tilted.
  double own_focal_px = 0, own_error_px = 0;
  double tilt_deg = 0;  ///< angle of the line of sight to the board's middle from the normal; 0 without a pose
};

struct TagCoverage {
  double focal_px = 0;  ///< shared; rough (no distortion, the center of the picture); 0 if no photo has a pose
  std::vector<TagView> views;
  double frame_share = 0;  ///< share of the frame within the tags of some photo
  /// Ratio of the tags' sides, at the scale of their centers, to size_mm: median over photos with four and more tags; 0
  /// if there are none. Differs from 1 by print and lens only.
  double size_ratio = 0;
  double direction_deg = 0;  ///< the largest angle between two of the normals
};

/// `looks` has one entry per camera position.
TagCoverage tag_coverage(std::span<const PhotoLook* const> looks, const TagSet& tags);

}  // namespace burin
