// burin/optimize/design/glint_check.h - whether a design's views can glint at all (glint.h) and which of them share
// scratches (collisions.h): said before the design runs. Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/design/glint.h"

namespace burin {

/// Throws Error if a camera or lamp lies behind the face or no groove on the area min..max can glint for a view (by how
/// many degrees, and the depth or lean that would do). Finds views that glint on part of the area only, and
/// pairs of views that one scratch serves at once (collisions; orientation counts modulo 180 degrees) with how much.
std::vector<Finding> check_glints(const std::vector<GlintView>& views, const Eigen::Vector2d& min_mm,
                                  const Eigen::Vector2d& max_mm, double width_um, const GrooveAt& groove_at);

}  // namespace burin
