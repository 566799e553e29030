// burin/optimize/design/direction_light.h - light from scratches of every direction in a view, measured with the
// renderer, for lights other than one lamp. docs/model.md 10.11. Frame: board, mm.
//
// The renderer renders short test scratches of all directions at a lattice of places. The best direction, and the turn
// that halves the light above its minimum, define the closest lamp's lobe (model.md 3.4). The minimum itself, which
// scratches of any direction send, limits a picture's blacks.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/optimize/design/glint.h"
#include "burin/render/view_renderer.h"

namespace burin {

/// The light of scratches at the middle of an area, by direction, and the field over all of it.
struct DirectionLight {
  std::vector<double> light;  ///< of scratches at k * 180 / size degrees: radiance times pixels, per mm of length
  GlintField field;
  double best = 0, least = 0;  ///< of `light`
  double face = 0;             ///< mean radiance of the plain face
  /// Ratio of light, best to worst direction; at most a thousand.
  double contrast() const { return best / std::max(least, 1e-3 * best); }
  double at(double angle) const;  ///< light of a scratch of this direction (radians)
};

/// Measures over the area min..max, which the renderer's pixels cover. `alpha`: roughness of grooves there.
DirectionLight measure_directions(ViewRenderer& renderer, const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm,
                                  double alpha, const std::function<Carved(const Scratches&)>& carve);

/// A view and its measured directions.
struct MeasuredView {
  std::string name, light;  ///< names of the view and of its light
  DirectionLight directions;
  bool told_by_angles = false;  ///< one lamp of a view in color: check_glints() reports its crosstalk
};

/// Findings on pictures under such lights: notes of the directions' contrast, warnings if it is too small for a
/// picture, and warnings of views with common scratches.
std::vector<Finding> check_directions(const std::vector<MeasuredView>& views);

}  // namespace burin
