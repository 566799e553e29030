#include "burin/scene/files/camera_effects_json.h"

#include <algorithm>
#include <string>

namespace burin {
namespace {

Glare read_glare(JsonObject json, Sensor& sensor) {
  Glare glare;
  glare.share = json.number("share", 0);
  if (!(glare.share >= 0 && glare.share < 0.5))
    json.fail_field("share", "is " + Json(glare.share).dump(),
                    "write the part of the light that is scattered, 0 to 0.5");
  glare.core_px = json.positive("core_px", glare.core_px);
  glare.reach_px = json.positive("reach_px", glare.reach_px);
  if (!(glare.reach_px > glare.core_px)) json.fail_field("reach_px", "is below core_px", "write a longer reach");
  if (json.has("share_sigma")) sensor.glare_share_sigma = json.positive("share_sigma");
  json.finish();
  return glare;
}

}  // namespace

Response read_response(JsonObject json) {
  Response response;
  if (json.has("contrast")) {
    const double contrast = json.positive("contrast"), pivot = json.number("pivot", 0.5);
    if (!(pivot > 0 && pivot < 1))
      json.fail_field("pivot", "is " + Json(pivot).dump(), "write a stored value between 0 and 1, not at its ends");
    response = s_curve(contrast, pivot);
  } else {
    response.offset = json.number("offset", 0);
    response.slope = json.number("slope", 0);
    if (json.has("bumps")) {
      const auto bumps = json.numbers("bumps", Response::kBumps);
      std::copy(bumps.begin(), bumps.end(), response.bumps.begin());
    }
  }
  if (!is_monotonic(response))
    json.fail_field("slope", "makes a curve that is not monotonic: more light would be stored as less",
                    "correct the curve, or leave it out and take brackets of three exposures");
  json.finish();
  return response;
}

Json response_json(const Response& r) {
  Json json;
  json["offset"] = r.offset;
  json["slope"] = r.slope;
  json["bumps"] = r.bumps;
  return json;
}

Sharpening read_sharpening(JsonObject json) {
  Sharpening sharpening;
  sharpening.amount = json.number("amount", 0);
  if (!(sharpening.amount >= 0 && sharpening.amount <= 5))
    json.fail_field("amount", "is " + Json(sharpening.amount).dump(), "write 0 (none) to 5");
  sharpening.sigma_px = json.positive("sigma_px", sharpening.sigma_px);
  json.finish();
  return sharpening;
}

Json sharpening_json(const Sharpening& sharpening) {
  Json json;
  json["amount"] = sharpening.amount;
  json["sigma_px"] = sharpening.sigma_px;
  return json;
}

namespace {

GreenSites read_green_sites(JsonObject& json) {
  const std::string said = json.text("green_sites");
  if (said == "even") return GreenSites::even;
  if (said == "odd") return GreenSites::odd;
  json.fail_field("green_sites", "is \"" + said + "\"",
                  "write \"even\" or \"odd\" (x + y of the pixels that measured green), or leave it out");
}

}  // namespace

void read_camera_effects(JsonObject& json, Sensor& sensor) {
  if (json.has("glare")) sensor.glare = read_glare(json.object("glare"), sensor);
  if (json.has("response")) sensor.response = read_response(json.object("response"));
  if (json.has("sharpening")) sensor.sharpening = read_sharpening(json.object("sharpening"));
  if (json.has("green_sites")) sensor.green_sites = read_green_sites(json);
  if (json.has("balance"))
    for (JsonObject& item : json.objects("balance")) {
      const std::string file = item.text("file");
      const Eigen::Vector3d rgb = item.vec3("rgb");
      if (!(rgb.array() > 0).all()) item.fail_field("rgb", "is not positive", "write three factors, 1 for none");
      sensor.balance[file] = rgb;
      item.finish();
    }
}

void put_camera_effects(const Sensor& sensor, Json& json) {
  if (sensor.glare.share > 0) {
    json["glare"]["share"] = sensor.glare.share;
    if (sensor.glare_share_sigma) json["glare"]["share_sigma"] = *sensor.glare_share_sigma;
    json["glare"]["core_px"] = sensor.glare.core_px;
    json["glare"]["reach_px"] = sensor.glare.reach_px;
  }
  if (!sensor.response.is_none()) json["response"] = response_json(sensor.response);
  if (sensor.sharpening.amount > 0) json["sharpening"] = sharpening_json(sensor.sharpening);
  if (sensor.green_sites != GreenSites::unknown)
    json["green_sites"] = sensor.green_sites == GreenSites::even ? "even" : "odd";
  for (const auto& [file, rgb] : sensor.balance) {
    Json item;
    item["file"] = file;
    item["rgb"] = to_json(rgb);
    json["balance"].push_back(std::move(item));
  }
}

}  // namespace burin
