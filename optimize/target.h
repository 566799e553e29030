// burin/optimize/target.h - any picture as the target of one view: gamma-encoded luminance on the pixels of the carve
// area.
//
// The result covers the board's grid (burin/scene/footprint_grid.h, board_grid): row 0 is at the carve area's top edge
// (largest y), white is 1. Color becomes luminance in linear light, encoded with gamma 2.2: designs are compared in
// this encoding (docs/model.md 5.10). A picture wider or higher than the area is cropped about its center, cropped so
// that one edge stays, or shown whole on black. Transparent pictures get a white ground. 16-bit pictures keep their
// depth. The values of .exr and .hdr count as linear.
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

/// A picture on a design's grid.
struct Target {
  Image picture;                  ///< one channel, 0..1, gamma-encoded
  Image mask;                     ///< one channel, 0..1; no pixels if every pixel counts
  std::vector<Finding> findings;  ///< "nearly black", "much smaller than the grid", ...
};

/// Placement of a picture of width x height pixels on an area.
struct LaidPicture {
  Eigen::Vector2d center_px{0,
                            0};  ///< the point of the picture at the area's middle; pixels from its upper left corner
  double mm_per_px = 1;          ///< size of its pixels on the area
  double width_lost = 0, height_lost = 0;  ///< the part outside of the area, 0 .. 1 of the picture's width and height
};
LaidPicture laid_picture(int width, int height, Fit fit, Keep keep, double rotation_deg,
                         const Eigen::Vector2d& area_mm);

/// Loads a target (from its file, or the image in memory) and places it on a grid of width x height pixels. The grid
/// covers an area of area_mm. `rotation_deg` is the final angle (spec.rotation_deg, or viewer_rotation_deg). Throws
/// Error for a missing or broken file, and for a picture of one tone.
Target load_target(const TargetSpec& spec, double rotation_deg, const Eigen::Vector2d& area_mm, int width, int height);

/// load_target() in color: red, green and blue as one target each, all with the mask. `levels` apply to each channel. A
/// picture without color gives three equal targets.
std::vector<Target> load_color_target(const TargetSpec& spec, double rotation_deg, const Eigen::Vector2d& area_mm,
                                      int width, int height);

/// The counter-clockwise rotation that makes a picture around p_board_mm upright in a view's photo: up in the photo
/// becomes up in the picture.
double viewer_rotation_deg(const View& view, const Eigen::Vector2d& p_board_mm);

/// The best possible version of a target on a bench: linear light is clamped from below at `floor`, the plain face's
/// light relative to white. It reveals hopeless targets (dark pictures on a bright face) before the run.
Image within_contrast(const Image& target, const Image& floor);

}  // namespace burin
