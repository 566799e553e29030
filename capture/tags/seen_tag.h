// burin/capture/tags/seen_tag.h - a tag in a photo for the pre-flight check. tag_look.h measures it.
#pragma once

#include <Eigen/Core>
#include <array>

namespace burin {

/// A tag in a photo for the pre-flight check.
struct TagLook {
  int id = 0;
  std::array<Eigen::Vector2d, 4> corner_px;  ///< AprilTag's (0.04 px), in TagDetection's order
  double white = 0;                          ///< median linear value of its white cells
  double clipped_fraction = 0;               ///< clipped share of its white cells' centers
};

}  // namespace burin
