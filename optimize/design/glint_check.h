// burin/optimize/design/glint_check.h - whether a design's views can glint at all (glint.h), and which of them share
// scratches (collisions.h). The checks run before the design. Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/design/glint.h"

namespace burin {

/// Throws Error if a camera or lamp is behind the face, or if no groove on the area min..max can glint for a view. The
/// message has the missing degrees, and a sufficient depth or tilt. Finds views that glint on part of the area only,
/// and pairs of views with common scratches (collisions; orientations modulo 180 degrees), with their crosstalk.
std::vector<Finding> check_glints(const std::vector<GlintView>& views, const Eigen::Vector2d& min_mm,
                                  const Eigen::Vector2d& max_mm, double width_um, const GrooveAt& groove_at);

}  // namespace burin
