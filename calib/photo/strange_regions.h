// burin/calib/photo/strange_regions.h - detects places on the metal unlike the board in most photos: a sticker,
// fingerprints, a stain. Frame: board, mm.
//
// A robust loss forgives such pixels, but silently, and grooves under them are not measured. An object on the face is
// there in all photos. Model errors (groove-to-groove variation, a pose) rarely affect every pixel of a place in most
// photos. The board is therefore divided into squares. A square is strange in a photo if at least half of its pixels
// exceed four expected errors. It is strange altogether if it is so in at least half of its photos, and in two.
// Touching strange squares form a region. Regions of fewer than four squares are dust, which the loss forgives.
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

/// Regions at `state`, the largest first, with photos weighed (weigh_photos_and_grooves). Empty if they make up a third
/// or more of the visible metal: then the model is wrong, and leaving out contradictions would hide it.
std::vector<StrangeRegion> strange_regions(const Problem& data, const State& state);

/// Marks pixels of the regions, and of one square around them, as not valid in `views` (the source of the problem's
/// photos by photos_at()).
void leave_out(const std::vector<StrangeRegion>& regions, const Problem& data, std::vector<LightView>& views);

/// "a region of 12 x 8 mm at (40, 55) mm does not look like the board in 6 of 7 photos: a sticker, or fingerprints?
/// ..."
Finding told(const StrangeRegion& region);

}  // namespace burin
