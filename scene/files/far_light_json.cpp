#include "burin/scene/files/far_light_json.h"

#include <cmath>
#include <string>
#include <utility>

#include "burin/base/error.h"
#include "burin/base/image.h"
#include "burin/pictures/picture.h"
#include "burin/scene/far_light.h"

namespace burin {
namespace {

constexpr const char* kFrameRemedy =
    "write \"frame\": \"board\" (row 0 at +z, straight out of the face, columns by azimuth from +x counter-clockwise), "
    "or \"inside\" for a panorama as one sees it from within, with \"up\" and \"middle\", the board's directions of "
    "its top row and its middle column";

Light read_sun(JsonObject json) {
  const Eigen::Vector3d to = json.vec3("direction");
  if (!(to.norm() > 1e-9))
    json.fail_field("direction", "has no direction", "write where the sun stands from the board");
  if (!(to.z() > 0))
    json.fail_field("direction", "lies behind the board's face",
                    "z points out of the metal: write a direction with z above 0, or turn the board");
  const double diameter = json.number("diameter_deg", 0.53);
  if (!(diameter >= 0 && diameter <= 5))
    json.fail_field("diameter_deg", "is " + Json(diameter).dump(),
                    "the sun's is 0.53; write a larger light as a lamp with a size, or as surroundings");
  Light out = sun_light(to, light_color(json, "irradiance", {1, 1, 1}), diameter);
  json.finish();
  return out;
}

Light read_surroundings(JsonObject json, const std::filesystem::path& file) {
  PanoramaFrame frame;
  if (!json.has("frame")) json.fail_field("frame", "is missing: the picture's orientation is unknown", kFrameRemedy);
  const std::string kind = json.text("frame");
  if (kind != "board" && kind != "inside") json.fail_field("frame", "is \"" + kind + "\"", kFrameRemedy);
  if (kind == "inside") {
    frame.kind = PanoramaFrame::Kind::inside;
    frame.up = json.vec3("up", frame.up);
    frame.middle = json.vec3("middle", frame.middle);
  } else if (json.has("up") || json.has("middle")) {
    json.fail_field("frame", "is \"board\", which has its directions already",
                    "leave out \"up\" and \"middle\", or write \"inside\"");
  }
  const std::filesystem::path picture = resolve_path(file, json.text("picture"));
  Light out = surroundings_light(make_panorama(read_picture(picture), frame, picture.string()),
                                 light_color(json, "intensity", {1, 1, 1}));
  if (json.has("intensity_sigma")) out.intensity_sigma = light_color(json, "intensity_sigma", {0, 0, 0});
  auto far = std::make_shared<FarLight>(*out.far);
  far->picture = picture;
  far->frame = frame;
  out.far = std::move(far);
  json.finish();
  return out;
}

}  // namespace

Eigen::Vector3d light_color(JsonObject& json, const std::string& key, const Eigen::Vector3d& fallback) {
  Eigen::Vector3d v = json.vec3(key, fallback);
  if ((v.array() < 0).any()) json.fail_field(key, "is " + to_json(v).dump(), "light is 0 or greater");
  return v;
}

bool says_far_light(JsonObject& light) { return light.has("sun") || light.has("surroundings"); }

void read_far_light(JsonObject& json, const std::filesystem::path& file, Light& light) {
  const std::string id = light.id;
  if (json.has("sun") && json.has("surroundings"))
    json.fail_field("surroundings", "contradicts sun", "a light is one of both: list them as two lights");
  for (const char* key : {"position_mm", "axis", "falloff_exponent", "disk_mm", "panel_mm", "intensity"})
    if (json.has(key))
      json.fail_field(key, "contradicts a sun or surroundings", "it belongs to a near lamp: list that as its own");
  light = json.has("sun") ? read_sun(json.object("sun")) : read_surroundings(json.object("surroundings"), file);
  light.id = id;
}

void put_far_light(const Light& light, const std::filesystem::path& file, Json& json) {
  const FarLight& far = *light.far;
  if (far.is_sun()) {
    json["sun"] = {{"direction", to_json(far.direction)},
                   {"irradiance", to_json(light.intensity)},
                   {"diameter_deg", far.diameter_deg}};
    return;
  }
  if (far.picture.empty())
    fail("light " + light.id, "has surroundings in memory, which a file cannot name",
         "write_picture() them as .exr, and name that");
  Json& to = json["surroundings"];
  to["picture"] = path_beside(file, far.picture);
  to["frame"] = far.frame.kind == PanoramaFrame::Kind::board ? "board" : "inside";
  if (far.frame.kind == PanoramaFrame::Kind::inside) {
    to["up"] = to_json(far.frame.up);
    to["middle"] = to_json(far.frame.middle);
  }
  to["intensity"] = to_json(light.intensity);
  if (light.intensity_sigma) to["intensity_sigma"] = to_json(*light.intensity_sigma);
}

}  // namespace burin
