// burin/render/scene_parts.h - a lamp with an area as the points that stand for it (lamp_size.h): a scene each.
// docs/model.md 5.5.
#pragma once

#include <vector>

#include "burin/base/image.h"
#include "burin/render/view_scene.h"

namespace burin {

/// The scenes of a lamp's points (lamp_points()), and their shares: light is the mean over them. `few` as there.
struct ScenePart {
  ViewScene scene;
  double share = 1;
};
std::vector<ScenePart> scene_parts(const ViewScene& scene, bool few = false);

/// Adds a share of an image to a sum, which is empty at first.
void add_share(const Image& image, double share, Image& sum);

}  // namespace burin
