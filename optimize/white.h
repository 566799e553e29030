// burin/optimize/white.h - which lights can be made to look white in pictures in color (White, design_file.h).
#pragma once

#include <Eigen/Core>

namespace burin {

/// Whether factors on the channels can make white of a light, R G B: all above 0, none more than a thousand times
/// another. Beyond that the rest of the channels would be black.
inline bool can_be_white(const Eigen::Vector3d& rgb) {
  constexpr double kMostApart = 1e3;
  return rgb.allFinite() && rgb.minCoeff() > 0 && rgb.maxCoeff() <= kMostApart * rgb.minCoeff();
}

}  // namespace burin
