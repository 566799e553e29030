// tools/view/packed_scratches.h - grooves as a page carries them: 8 bytes each, and two more for each number that
// differs from groove to groove. Frame: board, mm.
#pragma once

#include <string>

#include "burin/scene/carve.h"

namespace burin {

/// What rows share where they carry no number of their own.
struct SharedGroove {
  double width_um = 0, depth_um = 0, alpha = 0;
};

/// JSON: { count, min_mm, max_mm, longest_mm, rows, width_um, depth_um, alpha }. `rows` is base64 of four little-endian
/// 16-bit numbers a groove: its middle's x and y (0 and 65535: min_mm and max_mm), its direction (65536 would be 180
/// degrees from x, counter-clockwise) and its length (65535: longest_mm). The last three are { min, max, rows }, two
/// bytes a groove, without "rows" where all have the smallest. Grooves longer than `longest_mm` are cut into pieces: a
/// page takes their light at both ends and draws it in a straight line between. Steps are 1/65536 of the board's size,
/// some 3 um.
std::string packed_scratches(const Carved& carved, const SharedGroove& shared, double longest_mm);

}  // namespace burin
