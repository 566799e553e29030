// burin/calib/light/probe/probe_panorama.h - merges pictures of a mirror ball from several viewpoints into one
// latitude-longitude environment map. It averages and does not splat, so a small bright lamp keeps its light.
// docs/model.md 11.5. Frame: board (row 0 at +z, columns by azimuth from +x counter-clockwise: far_light.h).
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "burin/base/image.h"
#include "burin/calib/light/probe/mirror_ball.h"
#include "burin/calib/light/probe/seen.h"
#include "burin/scene/lens.h"

namespace burin {

/// One viewpoint's picture of the ball, all exposures merged.
struct BallPicture {
  Lens lens;  ///< of the whole photo
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
  Eigen::Vector3d vignette{0, 0, 0};
  Image value;                      ///< linear, 3 channels: value / exposure; a part of the photo
  std::vector<std::uint8_t> valid;  ///< of `value`: 0 for a lower bound, clipped in every exposure
  Eigen::Vector2d origin_px{0, 0};  ///< of its first pixel's center, in pixels of the photo
  double scale = 1;                 ///< pixels of the photo per pixel

  Eigen::Vector3d eye_mm() const { return T_camera_board.inverse().translation(); }
};

/// Options of the merge.
struct ProbeMerge {
  int width = 512;                 ///< of the panorama, pixels; half as high
  double photographer_rad = 0.44;  ///< half angle of the cone about the camera that is left out if another view sees it
  Eigen::Vector2d board_mm{0, 0};  ///< the board's reflection is left out
};

/// Environment map of a ball, times the ball's reflectance.
struct ProbePanorama {
  Image radiance;          ///< 3 channels
  std::vector<Seen> seen;  ///< per pixel
};

/// Deterministic for any number of threads.
ProbePanorama probe_panorama(std::span<const BallPicture> pictures, const MirrorBall& ball, const ProbeMerge& how);

/// Width of a panorama with the resolution of the pictures at the ball's middle: from 256 to 2,048 pixels.
int panorama_width(std::span<const BallPicture> pictures, const MirrorBall& ball);

}  // namespace burin
