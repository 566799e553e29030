// tools/report/rectified.h - rectified photos: the board as seen perpendicularly, and pictures of it. Frame: board, mm;
// row 0 of a rectified picture is the largest y.
#pragma once

#include <Eigen/Geometry>

#include "burin/base/image.h"
#include "burin/scene/lens.h"
#include "burin/scene/surface.h"

namespace burin {

/// A rectangle of the board and its resolution in pixels.
struct BoardFrame {
  Eigen::Vector2d min_mm{0, 0}, max_mm{0, 0};
  int width = 0, height = 0;
};

/// Returns the carve area with `long_side_px` on its longer side.
BoardFrame board_frame(const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm, int long_side_px);

/// Samples `photo` at the frame's places on the face. Pixel (0, 0) of `photo` is pixel (x0, y0) of the camera.
/// Interpolation is bilinear, and each value is the mean of 2 x 2 samples. NaN outside of the photo; infinite (clipped)
/// next to clipped pixels.
Image rectified(const Image& photo, int x0, int y0, const Lens& lens, const Eigen::Isometry3d& T_camera_board,
                const Surface& surface, const BoardFrame& frame);

/// Returns the value below which `fraction` of the finite values are; 0 without finite values.
float percentile(const Image& image, double fraction);

/// Encodes linear values for display: value / white, then gamma 1/2.2. NaN and negative values are black, infinite ones
/// white.
Image shown(const Image& linear, float white);

/// Displays photo - predicted over `white`: red if the photo is brighter, blue if it is darker, white if they agree.
/// Full color at +-`full_scale`. Gray if either value is missing.
Image difference_shown(const Image& photo, const Image& predicted, float white, float full_scale);

}  // namespace burin
