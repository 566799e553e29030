#include "burin/scene/files/profile_json.h"

#include <cmath>

namespace burin {
namespace {

constexpr double kSteepest_deg = 75, kMostAcross = 5;

double not_negative(JsonObject& json, const std::string& key, double v) {
  if (v < 0) json.fail_field(key, "is " + Json(v).dump(), "write 0 or more");
  return v;
}

}  // namespace

GrooveProfile read_profile(JsonObject json) {
  GrooveProfile p;
  const std::string kind = json.text("kind", "paper");
  if (kind != "paper" && kind != "rounded-v")
    json.fail_field("kind", "\"" + kind + "\" is not known",
                    "write \"rounded-v\" (an arc of a circle, then flanks) or \"paper\"");
  if (kind == "rounded-v") {
    p.kind = GrooveProfile::Kind::rounded_v;
    p.flank_deg = json.number("flank_deg");
    if (!(p.flank_deg > 0 && p.flank_deg <= kSteepest_deg))
      json.fail_field("flank_deg", "is " + Json(p.flank_deg).dump(),
                      "write the flanks' slope in degrees from the face, above 0 and up to 75");
  }
  if (json.has("tip_radius_um")) p.tip_radius_um = json.positive("tip_radius_um");
  if (json.has("burr_height_um")) {
    const Eigen::Vector2d height = json.vec2("burr_height_um");
    p.burr_left_um = not_negative(json, "burr_height_um", height.x());
    p.burr_right_um = not_negative(json, "burr_height_um", height.y());
  }
  p.burr_width_um = json.positive("burr_width_um", p.burr_width_um);
  p.across = json.positive("alpha_across", 1);
  if (p.across > kMostAcross || p.across < 1 / kMostAcross)
    json.fail_field("alpha_across", "is " + Json(p.across).dump(),
                    "write roughness across the groove over that along it, from 0.2 to 5");
  for (const char* key : {"flank_sigma_deg", "alpha_across_sigma", "burr_height_sigma_um", "burr_width_sigma_um"})
    json.has(key);
  json.finish();
  return p;
}

Json profile_json(const GrooveProfile& p) {
  Json json;
  const bool v = p.kind == GrooveProfile::Kind::rounded_v;
  json["kind"] = v ? "rounded-v" : "paper";
  if (v) json["flank_deg"] = p.flank_deg;
  if (p.tip_radius_um > 0) json["tip_radius_um"] = p.tip_radius_um;
  if (p.has_burrs()) {
    json["burr_height_um"] = {p.burr_left_um, p.burr_right_um};
    json["burr_width_um"] = p.burr_width_um;
  }
  if (p.across != 1) json["alpha_across"] = p.across;
  return json;
}

void read_grain_into(JsonObject& json, Material& material) {
  const double along_deg = json.number("along_deg");
  const auto roughness = [&](const char* key) {
    const double v = json.positive(key);
    if (v > 1) json.fail_field(key, "is " + Json(v).dump(), "write a roughness above 0 and up to 1");
    return v;
  };
  const double along = roughness("alpha_along"), across = roughness("alpha_across");
  material.grain = FaceGrain::of(along_deg, along, across);
  material.base_alpha = std::sqrt(along * across);
}

void read_grain(JsonObject json, Material& material) {
  read_grain_into(json, material);
  json.has("sigma");
  json.finish();
}

Json grain_json(const Material& m) {
  const double root = std::sqrt(m.grain.ratio());
  return {
      {"along_deg", m.grain.along_deg()}, {"alpha_along", m.base_alpha / root}, {"alpha_across", m.base_alpha * root}};
}

}  // namespace burin
