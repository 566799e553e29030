// burin/capture/tags/seen_tag.h - a tag in a photo as pre-flight sees it. tag_look.h looks.
#pragma once

#include <Eigen/Core>
#include <array>

namespace burin {

/// A tag as pre-flight sees it.
struct TagLook {
  int id = 0;
  std::array<Eigen::Vector2d, 4> corner_px;  ///< AprilTag's (0.04 px), in TagDetection's order
  double white = 0;                          ///< median linear value of its white cells
  double clipped_fraction = 0;               ///< of its white cells' centers
};

}  // namespace burin
