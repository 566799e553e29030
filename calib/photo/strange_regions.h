// burin/calib/photo/strange_regions.h - places on the metal that do not look like the board in most photos: a sticker,
// fingerprints, a stain. Frame: board, mm.
//
// A robust loss forgives such pixels, but nobody is told, and no groove under them is measured. What lies on the face
// lies there in all photos; errors of the model (grooves that differ, a pose) do not make every pixel of a place wrong
// in most of them. So the board is cut into squares; a square is strange in a photo where at least half of its pixels
// are beyond four expected errors, and strange altogether where that is so in at least half of the photos that see it,
// and in two. Strange squares that touch are a region; regions of fewer than four squares are dust, which the loss
// forgives.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

#include "burin/base/finding.h"
#include "burin/calib/light/light_samples.h"
#include "burin/calib/photo/photo_problem.h"

namespace burin {

struct StrangeRegion {
  Eigen::Vector2d min_mm{0, 0}, max_mm{0, 0};  ///< of its squares
  std::vector<Eigen::Vector2i> squares;        ///< column, row: of 2 mm, larger on a board of meters
  std::size_t strange_in = 0, seen_in = 0;     ///< photos, at most over its squares
};

inline constexpr double kStrangeSquareMm = 2;

/// At `state`, photos weighed (weigh_photos_and_grooves). The largest first. None where they make up a third of what is
/// seen of the metal or more: then it is the model that is wrong, and leaving out what contradicts would hide that.
std::vector<StrangeRegion> strange_regions(const Problem& data, const State& state);

/// Marks as not valid what `views` (of which photos_at() made the problem's photos) see of the regions and of one
/// square around them.
void leave_out(const std::vector<StrangeRegion>& regions, const Problem& data, std::vector<LightView>& views);

/// "a region of 12 x 8 mm at (40, 55) mm does not look like the board in 6 of 7 photos: a sticker, or fingerprints?
/// ..."
Finding told(const StrangeRegion& region);

}  // namespace burin
