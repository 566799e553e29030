// burin/calib/light/lamp_shapes.h - selects the model of lamps and face: spotlights, area lights, a brushed face,
// glossy paper, an unmodeled lamp. Each is taken if it explains paper and face much better than a bare point or a plain
// face. docs/model.md 9 'Lamp'. Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "burin/calib/light/lamp_fit.h"

namespace burin {

/// Present model of the lamps.
struct LampShapes {
  LampFit fit;
  std::vector<bool> spot;  ///< of each lamp; others keep exponent 0, or a plane's if they have an area
  /// Displacement of each lamp under a shape with a slightly better fit, or hardly better. Photos then do not decide
  /// between the shapes.
  std::vector<Eigen::Vector3d> moved_mm;
};

/// Tries bare lamps as spotlights, one after the other, if they explain much more. `usable`: lamps to try.
void try_spots(const LampData& data, const std::vector<bool>& usable, LampShapes& shapes);

/// Tries area lights, a brushed face and glossy paper, the one with the largest gain first: a long lamp stretches a
/// highlight as brushing does. Returns true if it took any.
bool try_areas_and_coats(const LampData& data, const std::vector<bool>& usable, LampShapes& shapes);

/// Tries bare lamps with one unmodeled lamp, from `by_paper` and from directions all over the sky. `by_paper` holds
/// bare lamps from paper alone: a second highlight on the face leads away from the true lamp. Replaces the fit of
/// `shapes`, and returns true, if paper and face fit much better.
bool try_stray(const LampData& data, const LampParameters& by_paper, LampShapes& shapes);

}  // namespace burin
