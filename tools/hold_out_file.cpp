#include "tools/hold_out_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "burin/base/files/json_file.h"

namespace burin {
namespace {

constexpr const char* kName = "hold-out.json";

PhotoFit read_fit(JsonObject json, const std::string& view, const std::string& light) {
  PhotoFit fit;
  fit.view = view;
  fit.light = light;
  fit.residual_rms = json.number("residual_rms");
  fit.residual_to_noise = json.number("residual_to_noise");
  fit.outliers = json.number("outliers");
  json.finish();
  return fit;
}

Json fit_json(const PhotoFit& fit) {
  return {{"residual_rms", fit.residual_rms}, {"residual_to_noise", fit.residual_to_noise}, {"outliers", fit.outliers}};
}

}  // namespace

HoldOutFile read_hold_out(const std::filesystem::path& folder) {
  HoldOutFile out;
  if (!std::filesystem::exists(folder / kName)) return out;
  const Json content = read_json(folder / kName, "burin/hold-out", 1);
  JsonObject json(content, (folder / kName).string());
  if (json.has("corners")) {
    JsonObject item = json.object("corners");
    HeldOutCorners& corners = out.corners.emplace();
    corners.fit_rms_px = item.number("fit_rms_px");
    corners.held_out_rms_px = item.number("held_out_rms_px");
    corners.expected_rms_px = item.number("expected_rms_px");
    for (JsonObject& view : item.objects("views")) {
      corners.views.push_back({view.text("view"), view.integer("tags"), view.number("fit_rms_px"),
                               view.number("held_out_rms_px"), view.number("expected_rms_px")});
      view.finish();
    }
    item.finish();
  }
  if (json.has("pixels"))
    for (JsonObject& photo : json.objects("pixels")) {
      const std::string view = photo.text("view"), light = photo.text("light");
      out.pixels.push_back(
          {read_fit(photo.object("fit"), view, light), read_fit(photo.object("held_out"), view, light)});
      photo.finish();
    }
  json.finish();
  return out;
}

Json to_json(const HoldOutFile& held) {
  Json json{{"format", "burin/hold-out"}, {"version", 1}};
  if (held.corners) {
    Json& corners = json["corners"];
    corners = {{"fit_rms_px", held.corners->fit_rms_px},
               {"held_out_rms_px", held.corners->held_out_rms_px},
               {"expected_rms_px", held.corners->expected_rms_px}};
    corners["views"] = Json::array();
    for (const HeldOutView& v : held.corners->views)
      corners["views"].push_back({{"view", v.view},
                                  {"tags", v.tags},
                                  {"fit_rms_px", v.fit_rms_px},
                                  {"held_out_rms_px", v.held_out_rms_px},
                                  {"expected_rms_px", v.expected_rms_px}});
  }
  if (!held.pixels.empty()) {
    json["pixels"] = Json::array();
    for (const HeldOutPhoto& photo : held.pixels)
      json["pixels"].push_back({{"view", photo.fit.view},
                                {"light", photo.fit.light},
                                {"fit", fit_json(photo.fit)},
                                {"held_out", fit_json(photo.held_out)}});
  }
  return json;
}

void write_hold_out(const HoldOutFile& held, const std::filesystem::path& folder) {
  write_json(to_json(held), folder / kName);
}

std::string corners_in_words(const HeldOutCorners& corners) {
  std::string out = fmt::format("held out {:>9} {:>6} {:>11} {:>11} {:>13}\n", "view", "tags", "when used", "held out",
                                "noise allows");
  for (const HeldOutView& v : corners.views)
    out += fmt::format("         {:>9} {:>6} {:>8.4f} px {:>8.4f} px {:>10.4f} px\n", v.view, v.tags, v.fit_rms_px,
                       v.held_out_rms_px, v.expected_rms_px);
  return out + fmt::format(
                   "         {:>9} {:>6} {:>8.4f} px {:>8.4f} px {:>10.4f} px: corners of tags that the pose was "
                   "not fitted to\n",
                   "all", "", corners.fit_rms_px, corners.held_out_rms_px, corners.expected_rms_px);
}

std::string pixels_in_words(const std::vector<HeldOutPhoto>& photos) {
  std::string out =
      fmt::format("held out {:>9} {:>12} {:>12} {:>22}\n", "view", "when used", "held out", "/ noise, used and not");
  for (const HeldOutPhoto& p : photos)
    out += fmt::format("         {:>9} {:>10.2f} % {:>10.2f} % {:>11.2f} {:>10.2f}\n", p.fit.view,
                       100 * p.fit.residual_rms, 100 * p.held_out.residual_rms, p.fit.residual_to_noise,
                       p.held_out.residual_to_noise);
  return out;
}

}  // namespace burin
