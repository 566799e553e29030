// burin/render/scene_parts.h - an area light as a set of points (lamp_size.h), with one scene per point. docs/model.md
// 5.5.
#pragma once

#include <vector>

#include "burin/base/image.h"
#include "burin/render/view_scene.h"

namespace burin {

/// Scene and share of one point of a lamp (lamp_points()). The light is the mean over the points. `few` as in
/// lamp_points().
struct ScenePart {
  ViewScene scene;
  double share = 1;
};
std::vector<ScenePart> scene_parts(const ViewScene& scene, bool few = false);

/// Adds a share of an image to a sum. An empty sum is allocated.
void add_share(const Image& image, double share, Image& sum);

}  // namespace burin
