#include "burin/render/scene_parts.h"

#include "burin/scene/lamp_size.h"

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

void add_share(const Image& image, double share, Image& sum) {
  if (sum.data.empty()) sum = Image(image.width, image.height, image.channels);
  for (std::size_t i = 0; i < image.data.size(); ++i) sum.data[i] += static_cast<float>(share) * image.data[i];
}

}  // namespace burin
