// tools/report/rectified.h - a photo as someone would see it who looks straight down at the board, and pictures of it.
// Frame: board, mm; row 0 of a rectified picture is the largest y.
#pragma once

#include <Eigen/Geometry>

#include "burin/base/image.h"
#include "burin/scene/lens.h"
#include "burin/scene/surface.h"

namespace burin {

/// A rectangle of the board and how many pixels it is shown with.
struct BoardFrame {
  Eigen::Vector2d min_mm{0, 0}, max_mm{0, 0};
  int width = 0, height = 0;
};

/// The carve area, `long_side_px` on its longer side.
BoardFrame board_frame(const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, int long_side_px);

/// Samples `photo` (pixel (0, 0) of it being pixel (x0, y0) of the camera) at the frame's places on the face; bilinear,
/// each value the mean of 2 x 2 samples. NaN where the photo does not reach; infinite (clipped) beside what is.
Image rectified(const Image& photo, int x0, int y0, const Lens& lens, const Eigen::Isometry3d& T_camera_board,
                const Surface& surface, const BoardFrame& frame);

/// The value below which `fraction` of the finite values lie; 0 if there are none.
float percentile(const Image& image, double fraction);

/// Linear values as shown: value / white, then gamma 1/2.2; NaN and negative values black, infinite ones white.
Image shown(const Image& linear, float white);

/// photo - predicted over `white`, red where the photo is brighter and blue where it is darker, white where they agree;
/// full color at +-`full_scale`. Gray where either is missing.
Image difference_shown(const Image& photo, const Image& predicted, float white, float full_scale);

}  // namespace burin
