// burin/optimize/design/collisions.h - which views of a design share scratches whether they want to or not: said before
// the design runs. Frame: board, mm; angles in radians. docs/model.md 3.4.
//
// A scratch serves each view for which it runs across the half vector's shadow, to within the lobe's width, and counts
// modulo 180 degrees. On a flat board directions hardly change over the board; on a curved one they do, so there the
// board is asked at many places.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/design/glint.h"

namespace burin {

/// Two views that share scratches.
struct Collision {
  std::size_t a = 0, b = 0;  ///< of the views, a < b
  double apart = 0;          ///< their scratches' directions in the middle of the area, 0 .. pi/2
  double ghost = 0;          ///< part of its light that a scratch made for one shows in the other: in the middle of a
                             ///< flat board, the mean over a curved one
  double worst = 0;          ///< its largest over the area
  double needed = 0;         ///< in the middle: how far apart they would have to be for kGhost
};

/// Part of a view's light that may show in another unmentioned.
inline constexpr double kGhost = 0.1;

/// The pairs whose ghost is kGhost or more, worst first.
std::vector<Collision> collisions_of(const std::vector<GlintView>& views, const Eigen::Vector2d& min_mm,
                                     const Eigen::Vector2d& max_mm, const GrooveAt& groove_at);

/// One warning a pair; from the seventh pair on one for all, which names the worst ones and tells whether it is
/// neighbors that share, as in a picture that moves, or views that should have nothing in common.
std::vector<Finding> told(const std::vector<Collision>& collisions, const std::vector<GlintView>& views);

}  // namespace burin
