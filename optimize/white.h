// burin/optimize/white.h - lights that can be made white in pictures in color (White, design_file.h).
#pragma once

#include <Eigen/Core>

namespace burin {

/// Whether factors on the channels can make a light R G B white: all channels are above 0, and none exceeds another by
/// more than a factor of a thousand. Beyond this ratio the other channels would be black.
inline bool can_be_white(const Eigen::Vector3d& rgb) {
  constexpr double kMostApart = 1e3;
  return rgb.allFinite() && rgb.minCoeff() > 0 && rgb.maxCoeff() <= kMostApart * rgb.minCoeff();
}

}  // namespace burin
