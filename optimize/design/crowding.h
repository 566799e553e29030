// burin/optimize/design/crowding.h - how many strokes a board has room for where grooves cut each other's rims away.
// docs/design.md, 'Where grooves cut each other's rims away'.
//
// Each stroke that comes takes light from those that it crosses. While strokes are few for their pictures, what it
// draws is worth more than that, however crowded the board; where they are many, it only makes the others' light
// uneven.
#pragma once

#include <cstddef>
#include <optional>

namespace burin {

/// As many of `strokes` as show most, where that is fewer. `a_stroke`: pixels of all pictures that each has to fill;
/// `cover`: how many times the grooves, side by side, would cover the carve area.
std::optional<std::size_t> fewer_strokes(std::size_t strokes, double a_stroke, double cover);

/// Whether the pixels are so fine that the strokes which fill them leave each other no light.
bool pixels_crowd(double cover);

}  // namespace burin
