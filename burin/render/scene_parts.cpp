#include "burin/render/scene_parts.h"

#include "burin/render/lamp_size.h"

namespace burin {

std::vector<ScenePart> scene_parts(const ViewScene& scene, bool few) {
  std::vector<ScenePart> out;
  for (const LampPoint& point : lamp_points(scene.light, few)) {
    out.push_back({scene, point.share});
    out.back().scene.light.position_mm += point.offset_mm;
    out.back().scene.light.size = {};
  }
  return out;
}

}  // namespace burin
