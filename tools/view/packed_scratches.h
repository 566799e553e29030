// tools/view/packed_scratches.h - compact form of grooves in a page: 8 bytes each, and two more for each varying
// property. Frame: board, mm.
#pragma once

#include <string>

#include "burin/scene/carve.h"

namespace burin {

/// Common properties of rows that have none of their own.
struct SharedGroove {
  double width_um = 0, depth_um = 0, alpha = 0;
};

/// Returns JSON: { count, min_mm, max_mm, longest_mm, rows, width_um, depth_um, alpha }. `rows` is base64 of four
/// little-endian 16-bit numbers per groove. They are x and y of its center (0 to 65535: min_mm to max_mm), its
/// direction and its length (65535: longest_mm). Directions are counter-clockwise from x; 65536 would be 180 degrees.
/// The last three members are { min, max, rows }, two bytes per groove, without "rows" if all are equal. Grooves longer
/// than `longest_mm` are cut into pieces, because a page interpolates a piece's light linearly between its ends. One
/// step is 1/65536 of the board's size, about 3 um.
std::string packed_scratches(const Carved& carved, const SharedGroove& shared, double longest_mm);

}  // namespace burin
