// burin/capture/tags/tag_coverage.h - what the tags in a session's photos say about it before anything is solved: how
// large they are, from which directions the board is seen, whether one lens explains all photos. Pixels: the center of
// the top-left pixel is (0, 0). Frames: board (mm), camera.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "burin/capture/photo_look.h"
#include "burin/scene/board.h"

namespace burin {

/// One photo's tags.
struct TagView {
  int tags = 0;
  double side_px = 0;  ///< median side; 0 without tags
  /// The board's normal in the camera's frame, and how badly the pose misses the tags (median, px), for the focal
  /// length that the session shares; none if fewer than four points agree with board.json.
  std::optional<Eigen::Vector3d> normal;
  double error_px = 0;
  /// The focal length that suits this photo best, and its error: of use where the board is tilted.
  double own_focal_px = 0, own_error_px = 0;
  double tilt_deg = 0;  ///< of the line of sight to the board's middle, from the normal; without a pose 0
};

struct TagCoverage {
  double focal_px = 0;  ///< shared; rough (no distortion, the center of the picture); 0 if no photo has a pose
  std::vector<TagView> views;
  double frame_share = 0;  ///< of the frame: what lies within the tags of some photo
  /// Of the tags' sides as they lie between their centers, over size_mm: the median of those in photos that show four
  /// and more; 0 if there are none. 1 but for print and lens.
  double size_ratio = 0;
  double direction_deg = 0;  ///< the largest angle between two of the normals
};

/// `looks`: one a place of the camera.
TagCoverage tag_coverage(std::span<const PhotoLook* const> looks, const TagSet& tags);

}  // namespace burin
