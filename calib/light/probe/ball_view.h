// burin/calib/light/probe/ball_view.h - one viewpoint's picture of a ball, in gray, with its pose. Frames: board (mm),
// camera, pixels of the photo (center of the top-left pixel is (0, 0)).
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "burin/base/image.h"
#include "burin/scene/lens.h"

namespace burin {

struct BallView {
  Lens lens;  ///< of the whole photo
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
  Image gray;                       ///< linear, one channel: the photo, a smaller copy of it, or a part
  Eigen::Vector2d origin_px{0, 0};  ///< of its first pixel's center, in pixels of the photo
  double scale = 1;                 ///< pixels of the photo per pixel
  /// Rays (unit, board) to visible places of the face, such as detected tags: no ball is in their way.
  std::vector<Eigen::Vector3d> free_rays;

  Eigen::Vector3d eye_mm() const { return T_camera_board.inverse().translation(); }
};

}  // namespace burin
