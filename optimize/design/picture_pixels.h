// burin/optimize/design/picture_pixels.h - how finely a design looks at its pictures: no finer than its strokes can
// fill. docs/design.md, 'How many pixels'.
//
// A stroke that has to fill many pixels is drawn long, through details that it cannot show; where grooves cut each
// other's rims away, long strokes leave each other little light (crowding). In larger pixels the same strokes are
// hatching, and right for all eyes that do not see these apart.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/design/design_views.h"
#include "burin/scene/crossings.h"

namespace burin {

/// Along the longer side of the carve area, where strokes can fill them.
inline constexpr int kUsualPixels = 512;

/// Along the longer side, the pixels that an eye so far away just tells apart: no more than kUsualPixels. How good a
/// design is counts in these, so that designs of any pixels can be compared.
int pixels_of_eyes(const Eigen::Vector2d& area_mm, double distance_mm);

/// Of all pictures, those that each of so many strokes has to fill.
double pixels_a_stroke(const std::vector<WorkView>& views, std::size_t strokes);

/// Fewer pixels along the longer side, where `a_stroke` are too many of `pixels`, or the strokes that fill them `crowd`
/// the board: no fewer than three quarters of them at once, since shorter strokes may be more. None where they suit, or
/// fewer would show no picture.
std::optional<int> fewer_pixels(int pixels, double a_stroke, bool crowd);

/// What a person should know of pictures whose `pixels` a design chose for so many strokes.
Finding pixels_were_chosen(const std::vector<WorkView>& views, std::size_t strokes, Crossings crossings);

/// The same where a person asked for pixels that these strokes cannot fill; none where they can.
std::optional<Finding> pixels_are_many(const std::vector<WorkView>& views, std::size_t strokes, Crossings crossings);

}  // namespace burin
