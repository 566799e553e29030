// burin/optimize/design/picture_pixels.h - number of a design's pixels: no more than its strokes can fill.
// docs/design.md, 'How many pixels'.
//
// A stroke for many pixels becomes long and crosses finer details. If grooves cut each other's rims away, long strokes
// also leave each other little light (crowding). In larger pixels the same strokes are hatching, which is right for
// every eye that does not resolve them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/design/design_views.h"
#include "burin/scene/crossings.h"

namespace burin {

/// Pixels along the longer side of the carve area, if strokes can fill them.
inline constexpr int kUsualPixels = 512;

/// Resolution of an eye at this distance, in pixels along the longer side, at most kUsualPixels. The figure of merit of
/// a design uses them, so designs of any pixels are comparable.
int pixels_of_eyes(const Eigen::Vector2d& area_mm, double distance_mm);

/// Pixels of all pictures per stroke.
double pixels_a_stroke(const std::vector<WorkView>& views, std::size_t strokes);

/// A smaller number of pixels along the longer side, if `a_stroke` is too large at `pixels` or if the strokes that fill
/// them `crowd` the board. It is at least three quarters of `pixels` at once, because shorter strokes may be more. None
/// if the pixels suit, or if fewer would show no picture.
std::optional<int> fewer_pixels(int pixels, double a_stroke, bool crowd);

/// The finding about pictures whose `pixels` the design chose for this number of strokes.
Finding pixels_were_chosen(const std::vector<WorkView>& views, std::size_t strokes, Crossings crossings);

/// The finding about too many requested pixels for these strokes; none if they suit.
std::optional<Finding> pixels_are_many(const std::vector<WorkView>& views, std::size_t strokes, Crossings crossings);

}  // namespace burin
