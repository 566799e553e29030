// burin/optimize/design/direction_light.h - how much light scratches of every direction send to a view, measured with
// the renderer: what a search needs to know of lights that are not one lamp. docs/model.md 10.11. Frame: board, mm.
//
// Short test scratches of all directions lie at a lattice of places, and the renderer says what each sends. The best
// direction and the turn that halves the light above its floor say which lamp's lobe (model.md 3.4) comes closest; the
// floor itself, light that scratches of any direction send, is what takes a picture's blacks away.
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
  std::vector<double>
      light;  ///< of scratches that run at k * 180 / size degrees: radiance times pixels, a mm of length
  GlintField field;
  double best = 0, least = 0;  ///< of them
  double face = 0;             ///< mean radiance of the plain face
  /// How many times the light of the worst direction the best one sends; at most a thousand.
  double contrast() const { return best / std::max(least, 1e-3 * best); }
  double at(double angle) const;  ///< light of a scratch of that direction (radians)
};

/// Over the area min..max on which the renderer's pixels lie. `alpha`: of grooves there.
DirectionLight measure_directions(ViewRenderer& renderer, const Eigen::Vector2d& min_mm, const Eigen::Vector2d& max_mm,
                                  double alpha, const std::function<Carved(const Scratches&)>& carve);

/// A view by its measured directions.
struct MeasuredView {
  std::string name, light;  ///< its own, and that of the light it is seen under
  DirectionLight directions;
  bool told_by_angles = false;  ///< one lamp of a view in color: check_glints() tells what such lamps share
};

/// What a picture can hope for under such lights: notes of the contrast that directions have, warnings where it is too
/// small for a picture, and of views that one scratch serves at once.
std::vector<Finding> check_directions(const std::vector<MeasuredView>& views);

}  // namespace burin
