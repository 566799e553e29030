#include "burin/optimize/machine_measured_json.h"

#include <optional>
#include <string>
#include <utility>

namespace burin {
namespace {

std::optional<MeasuredNumber> number(JsonObject& json, const std::string& key, const std::string& sigma_key) {
  if (!json.has(key)) return std::nullopt;
  MeasuredNumber out{json.number(key), json.number(sigma_key)};
  if (out.sigma < 0) json.fail_field(sigma_key, "is negative", "write a standard deviation");
  return out;
}

void put(Json& json, const std::string& key, const std::string& sigma_key, const std::optional<MeasuredNumber>& v) {
  if (!v) return;
  json[key] = v->value;
  json[sigma_key] = v->sigma;
}

}  // namespace

MachineMeasured read_measured(JsonObject json) {
  MachineMeasured out;
  out.coupon = json.integer("coupon");
  out.date = json.text("date");
  out.tool_width_um = json.positive("tool_width_um");
  out.usual_feed_mm_min = json.positive("usual_feed_mm_min");
  out.usual_spacing_mm = json.positive("usual_spacing_mm");
  for (JsonObject& item : json.objects("cells")) {
    MeasuredCell cell;
    cell.command = item.number("command");
    cell.feed_mm_min = item.positive("feed_mm_min");
    cell.spacing_mm = item.positive("spacing_mm");
    cell.fans = item.integer("fans");
    cell.depth_um = number(item, "depth_um", "depth_sigma_um");
    cell.alpha = number(item, "alpha", "alpha_sigma");
    item.finish();
    out.cells.push_back(cell);
  }
  if (json.has("repeat")) {
    JsonObject repeat = json.object("repeat");
    out.repeat_depth = number(repeat, "depth", "depth_sigma");
    out.repeat_alpha = number(repeat, "alpha", "alpha_sigma");
    repeat.finish();
  }
  if (json.has("wear")) {
    JsonObject wear = json.object("wear");
    out.wear_over_mm = wear.positive("over_mm");
    out.wear_depth = number(wear, "depth", "depth_sigma");
    out.wear_alpha = number(wear, "alpha", "alpha_sigma");
    wear.finish();
  }
  if (json.has("travel")) {
    JsonObject travel = json.object("travel");
    out.travel_depth = number(travel, "depth", "depth_sigma");
    out.travel_towards_deg = travel.number("towards_deg");
    travel.finish();
  }
  json.finish();
  return out;
}

Json measured_json(const MachineMeasured& m) {
  Json json = {{"coupon", m.coupon},
               {"date", m.date},
               {"tool_width_um", m.tool_width_um},
               {"usual_feed_mm_min", m.usual_feed_mm_min},
               {"usual_spacing_mm", m.usual_spacing_mm},
               {"cells", Json::array()}};
  for (const MeasuredCell& cell : m.cells) {
    Json item = {{"command", cell.command},
                 {"feed_mm_min", cell.feed_mm_min},
                 {"spacing_mm", cell.spacing_mm},
                 {"fans", cell.fans}};
    put(item, "depth_um", "depth_sigma_um", cell.depth_um);
    put(item, "alpha", "alpha_sigma", cell.alpha);
    json["cells"].push_back(std::move(item));
  }
  if (m.repeat_depth || m.repeat_alpha) {
    json["repeat"] = Json::object();
    put(json["repeat"], "depth", "depth_sigma", m.repeat_depth);
    put(json["repeat"], "alpha", "alpha_sigma", m.repeat_alpha);
  }
  if (m.wear_depth || m.wear_alpha) {
    json["wear"] = {{"over_mm", m.wear_over_mm}};
    put(json["wear"], "depth", "depth_sigma", m.wear_depth);
    put(json["wear"], "alpha", "alpha_sigma", m.wear_alpha);
  }
  if (m.travel_depth) {
    json["travel"] = {{"towards_deg", m.travel_towards_deg}};
    put(json["travel"], "depth", "depth_sigma", m.travel_depth);
  }
  return json;
}

}  // namespace burin
