// burin/optimize/target.h - any picture as the target of one view: gamma-encoded luminance on the pixels of the carve
// area.
//
// The result is laid on the board's grid (burin/scene/footprint_grid.h, board_grid): row 0 at the carve area's top
// edge (largest y), white is 1. Color becomes luminance in linear light and is encoded with gamma 2.2, which is what
// designs are compared in (docs/model.md 5.10). Pictures wider or higher than the area are cropped about their center,
// or so that one edge stays (or shown whole on black), transparent ones lie on white, 16 bits keep theirs, .exr and
// .hdr are taken as linear.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/image.h"
#include "burin/optimize/design_file.h"
#include "burin/scene/bench.h"

namespace burin {

/// A picture laid on a design's grid.
struct Target {
  Image picture;                  ///< one channel, 0..1, gamma-encoded
  Image mask;                     ///< one channel, 0..1; no pixels if everything matters
  std::vector<Finding> findings;  ///< "nearly black", "much smaller than the grid", ...
};

/// How a picture of width x height pixels lies on an area: what of it is seen there, as shares of its width and height.
struct LaidPicture {
  Eigen::Vector2d center_px{0,
                            0};  ///< what of the picture lies on the area's middle; pixels from its upper left corner
  double mm_per_px = 1;          ///< the size that its pixels have on the area
  double width_lost = 0, height_lost = 0;  ///< what lies outside of the area, 0 .. 1 of the picture's
};
LaidPicture laid_picture(int width, int height, Fit fit, Keep keep, double rotation_deg,
                         const Eigen::Vector2d& area_mm);

/// Loads (from its file, or the image in memory) and lays a target on a grid of width x height pixels covering an area
/// of area_mm. `rotation_deg` is the final angle (spec.rotation_deg, or viewer_rotation_deg). Throws Error for a file
/// that is missing, broken or of one tone.
Target load_target(const TargetSpec& spec, double rotation_deg, const Eigen::Vector2d& area_mm, int width, int height);

/// The same in color: red, green and blue as a target each, all with the mask. `levels` apply to each channel. A
/// picture without color has three that are alike.
std::vector<Target> load_color_target(const TargetSpec& spec, double rotation_deg, const Eigen::Vector2d& area_mm,
                                      int width, int height);

/// How far a picture on the board must be turned, counter-clockwise, to stand upright in a view's photo when it lies
/// around p_board_mm: up on the photo becomes up in the picture.
double viewer_rotation_deg(const View& view, const Eigen::Vector2d& p_board_mm);

/// The target as a bench can show it at best: linear light squeezed between `floor`, the plain face's light relative
/// to white, and 1. What cannot work (dark pictures on a bright face) is seen here before the run.
Image within_contrast(const Image& target, const Image& floor);

}  // namespace burin
