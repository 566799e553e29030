// Which quadrilaterals share a point, by all separating axes: the brute force that pair finding is measured against.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "burin/render/fast/pairs.h"

namespace burin {

using Corners = std::array<Eigen::Vector2d, 4>;

inline Corners strip_corners(const Strip& s) {
  const Eigen::Vector2d d = (s.p1_mm - s.p0_mm).normalized();
  const Eigen::Vector2d x = s.half_width_mm * Eigen::Vector2d(d.y(), -d.x());
  return {s.p0_mm - x, s.p0_mm + x, s.p1_mm + x, s.p1_mm - x};
}

/// How deep two convex quadrilaterals overlap: the least overlap over all of their edges' normals; negative if apart.
inline double overlap_mm(const Corners& a, const Corners& b) {
  double least = std::numeric_limits<double>::infinity();
  for (const Corners* q : {&a, &b}) {
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector2d e = (*q)[(i + 1) % 4] - (*q)[i];
      if (!(e.norm() > 0)) continue;
      const Eigen::Vector2d n = Eigen::Vector2d(e.y(), -e.x()).normalized();
      double a0 = 1e300, a1 = -1e300, b0 = 1e300, b1 = -1e300;
      for (int k = 0; k < 4; ++k) {
        a0 = std::min(a0, n.dot(a[k]));
        a1 = std::max(a1, n.dot(a[k]));
        b0 = std::min(b0, n.dot(b[k]));
        b1 = std::max(b1, n.dot(b[k]));
      }
      least = std::min(least, std::min(a1, b1) - std::max(a0, b0));
    }
  }
  return least;
}

}  // namespace burin
