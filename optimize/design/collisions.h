// burin/optimize/design/collisions.h - views of a design with common scratches, found before the design runs. Frame:
// board, mm; angles in radians. docs/model.md 3.4.
//
// A scratch serves each view whose half vector's projection it crosses at a right angle, within the lobe's width.
// Orientations count modulo 180 degrees. On a flat board directions hardly change over the board. On a curved one they
// change, so the check covers many places of it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/design/glint.h"

namespace burin {

/// Two views that share scratches.
struct Collision {
  std::size_t a = 0, b = 0;  ///< indices of the views, a < b
  double apart = 0;          ///< between their scratches' directions in the middle of the area, 0 .. pi/2
  /// Crosstalk: share of its light that a scratch for one view sends to the other, in the middle of a flat board, or
  /// the mean over a curved one.
  double ghost = 0;
  double worst = 0;   ///< its largest over the area
  double needed = 0;  ///< in the middle: difference of directions for a crosstalk of kGhost
};

/// Largest crosstalk without a warning, as a part of a view's light.
inline constexpr double kGhost = 0.1;

/// The pairs with a crosstalk of kGhost or more, worst first.
std::vector<Collision> collisions_of(const std::vector<GlintView>& views, const Eigen::Vector2d& min_mm,
                                     const Eigen::Vector2d& max_mm, const GrooveAt& groove_at);

/// One warning per pair for up to six pairs. For more, a single warning names the worst ones. It distinguishes
/// neighbors with common scratches, as in a moving picture, from views of separate pictures.
std::vector<Finding> told(const std::vector<Collision>& collisions, const std::vector<GlintView>& views);

}  // namespace burin
