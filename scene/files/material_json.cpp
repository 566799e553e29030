#include "burin/scene/files/material_json.h"

#include <algorithm>
#include <string>

#include "burin/scene/files/profile_json.h"
#include "burin/scene/physical_bounds.h"

namespace burin {

Material read_material(JsonObject& json) {
  Material material;
  const auto roughness = [&](const std::string& key, double fallback) {
    const double v = json.number(key, fallback);
    if (!(v > 0 && v <= 1)) json.fail_field(key, "is " + Json(v).dump(), "write a roughness above 0 and up to 1");
    return v;
  };
  material.alpha = roughness("alpha", material.alpha);
  material.depth_um = read_depth_um(json, "depth_um", material.depth_um);
  material.base_alpha = roughness("base_alpha", material.base_alpha);
  material.f0 = json.vec3("f0", material.f0);
  if ((material.f0.array() < 0).any() || (material.f0.array() > 1).any())
    json.fail_field("f0", "is " + to_json(material.f0).dump(), "write three numbers from 0 to 1");
  if (json.has("brushed")) read_grain(json.object("brushed"), material);
  if (json.has("profile")) {
    material.profile = read_profile(json.object("profile"));
    const GrooveProfile& p = material.profile;
    if (std::max(p.burr_left_um, p.burr_right_um) > material.depth_um)
      json.fail_field("profile.burr_height_um", "is larger than depth_um",
                      "burrs stand lower than their groove is deep");
  }
  return material;
}

SaidMaterial said_material(const JsonObject& json) {
  return {json.has("alpha"), json.has("depth_um"), json.has("base_alpha"),
          json.has("f0"),    json.has("brushed"),  json.has("profile")};
}

}  // namespace burin
