// burin/calib/light/lamp_shapes.h - what lamps may be beside bare points, and the face beside plain: spots, lamps with
// an area, a brushed face, paper that shines, a lamp beside them that nobody named. Each is taken where it explains
// paper and face much better. docs/model.md 9 'Lamp'. Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "burin/calib/light/lamp_fit.h"

namespace burin {

/// Lamps as they were taken for until now.
struct LampShapes {
  LampFit fit;
  std::vector<bool> spot;  ///< of each lamp; others are held bare, or as a plane's where they have an area
  /// How far each lamp would be from where it is with a shape that explains a little more, or hardly: photos then do
  /// not say which it is.
  std::vector<Eigen::Vector3d> moved_mm;
};

/// Takes lamps that are none for spots, one after the other, where that explains much more. `usable`: lamps to ask for.
void try_spots(const LampData& data, const std::vector<bool>& usable, LampShapes& shapes);

/// Takes lamps for ones with an area, the face for a brushed one and the tags' paper for one that shines, whichever
/// explains more first: a long lamp draws a highlight out as brushing does. Whether it took any.
bool try_areas_and_coats(const LampData& data, const std::vector<bool>& usable, LampShapes& shapes);

/// Bare lamps and one more that nobody named, from `by_paper` (bare lamps that paper alone tells: a second highlight on
/// the face leads away from where the lamp is) and from directions all over the sky; taken in place of what `shapes`
/// has where it explains paper and face much better. Whether it was.
bool try_stray(const LampData& data, const LampParameters& by_paper, LampShapes& shapes);

}  // namespace burin
