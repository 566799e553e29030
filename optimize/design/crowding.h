// burin/optimize/design/crowding.h - number of strokes for a board if grooves cut each other's rims away.
// docs/design.md, 'Where grooves cut each other's rims away'.
//
// Each added stroke takes light from the crossed strokes. If strokes are few for their pictures, its own light is worth
// more than this, on any crowded board. If they are many, it only makes the others' light uneven.
#pragma once

#include <cstddef>
#include <optional>

namespace burin {

/// The best number of strokes, if it is smaller than `strokes`. `a_stroke`: pixels of all pictures per stroke; `cover`:
/// how many times the grooves, side by side, would cover the carve area.
std::optional<std::size_t> fewer_strokes(std::size_t strokes, double a_stroke, double cover);

/// Whether the strokes for such fine pixels would leave each other no light.
bool pixels_crowd(double cover);

}  // namespace burin
