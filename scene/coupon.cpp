#include "burin/scene/coupon.h"

#include "burin/base/error.h"
#include "burin/base/files/json_file.h"
#include "burin/scene/physical_bounds.h"

namespace burin {
namespace {

Json to_json(const CouponCell& cell) {
  return {{"command", cell.command},
          {"depth_um", cell.depth_um},
          {"feed_mm_min", cell.feed_mm_min},
          {"reached_mm_min", cell.reached_mm_min},
          {"spacing_mm", cell.spacing_mm}};
}

Json to_json(const CouponFan& fan) {
  return {{"cell", fan.cell},           {"center_mm", burin::to_json(fan.center_mm)},
          {"radius_mm", fan.radius_mm}, {"outward", fan.outward},
          {"first_row", fan.first_row}, {"rows", fan.rows}};
}

CouponCell read_cell(JsonObject& json) {
  CouponCell cell;
  cell.command = json.number("command");
  cell.depth_um = read_depth_um(json, "depth_um");
  cell.feed_mm_min = json.positive("feed_mm_min");
  cell.reached_mm_min = json.positive("reached_mm_min");
  cell.spacing_mm = json.positive("spacing_mm");
  json.finish();
  return cell;
}

std::size_t count_of(JsonObject& json, const std::string& key) {
  const int value = json.integer(key);
  if (value < 0) json.fail_field(key, "is " + std::to_string(value), "take coupon.json as burin coupon wrote it");
  return static_cast<std::size_t>(value);
}

CouponFan read_fan(JsonObject& json, std::size_t cells) {
  CouponFan fan;
  fan.cell = count_of(json, "cell");
  if (fan.cell >= cells)
    json.fail_field("cell", "is " + std::to_string(fan.cell) + " of " + std::to_string(cells),
                    "take coupon.json as burin coupon wrote it");
  fan.center_mm = json.vec2("center_mm");
  fan.radius_mm = json.positive("radius_mm");
  fan.outward = json.boolean("outward");
  fan.first_row = count_of(json, "first_row");
  fan.rows = count_of(json, "rows");
  json.finish();
  return fan;
}

}  // namespace

Coupon read_coupon(const std::filesystem::path& file) {
  const Json content = read_json(file, "burin/coupon", 1);
  JsonObject json(content, file.string());
  Coupon coupon;
  coupon.number = json.integer("number");
  if (coupon.number < 1 || coupon.number > kMostCoupons)
    json.fail_field("number", "is " + std::to_string(coupon.number), "write 1 to " + std::to_string(kMostCoupons));
  coupon.date = json.text("date");
  coupon.machine = json.text("machine");
  coupon.depth_by = json.text("depth_by");
  coupon.usual_feed_mm_min = json.positive("usual_feed_mm_min");
  coupon.at_mm = json.vec2("at_mm");
  for (JsonObject& cell : json.objects("cells")) coupon.cells.push_back(read_cell(cell));
  for (JsonObject& fan : json.objects("fans")) coupon.fans.push_back(read_fan(fan, coupon.cells.size()));
  if (coupon.fans.empty()) json.fail_field("fans", "is empty", "take coupon.json as burin coupon wrote it");
  coupon.lamp_mm = json.vec3("lamp_mm");
  for (JsonObject& item : json.objects("shots")) {
    coupon.shots.push_back({item.number("lean_deg"), item.vec3("eye_mm")});
    item.finish();
  }
  json.finish();
  return coupon;
}

void write_coupon(const Coupon& coupon, const std::filesystem::path& file) {
  Json json = {{"format", "burin/coupon"},
               {"version", 1},
               {"number", coupon.number},
               {"date", coupon.date},
               {"machine", coupon.machine},
               {"depth_by", coupon.depth_by},
               {"usual_feed_mm_min", coupon.usual_feed_mm_min},
               {"at_mm", burin::to_json(coupon.at_mm)},
               {"cells", Json::array()},
               {"fans", Json::array()},
               {"lamp_mm", burin::to_json(coupon.lamp_mm)},
               {"shots", Json::array()}};
  for (const CouponCell& cell : coupon.cells) json["cells"].push_back(to_json(cell));
  for (const CouponFan& fan : coupon.fans) json["fans"].push_back(to_json(fan));
  for (const CouponShot& shot : coupon.shots)
    json["shots"].push_back({{"lean_deg", shot.lean_deg}, {"eye_mm", burin::to_json(shot.eye_mm)}});
  write_json(json, file);
}

}  // namespace burin
