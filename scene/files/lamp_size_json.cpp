#include "burin/scene/files/lamp_size_json.h"

#include <cmath>
#include <string>

#include "burin/base/files/decimals.h"

namespace burin {
namespace {

void fail_if_too_large(const JsonObject& light, const std::string& key, double across_mm, double distance_mm) {
  if (across_mm < distance_mm) return;
  light.fail_field(key,
                   "makes a lamp of " + significant(across_mm, 3) + " mm, which stands only " +
                       significant(distance_mm, 3) + " mm away",
                   "a lamp as large as its distance lights no glints apart: move it away to twice its size or more, or "
                   "correct the number (mm)");
}

}  // namespace

LampSize read_lamp_size(JsonObject& light, const Eigen::Vector3d& position_mm) {
  LampSize size;
  const double distance_mm = position_mm.norm();
  if (light.has("disk_mm") && light.has("panel_mm"))
    light.fail_field("panel_mm", "contradicts disk_mm", "a lamp is a disk or a panel: keep one of both");
  if (light.has("disk_mm")) {
    size.disk_mm = light.number("disk_mm");
    if (size.disk_mm < 0) light.fail_field("disk_mm", "is negative", "write the disk's radius in mm, 0 for a point");
    fail_if_too_large(light, "disk_mm", 2 * size.disk_mm, distance_mm);
    if (light.has("disk_sigma_mm")) {
      size.disk_sigma_mm = light.number("disk_sigma_mm");
      if (*size.disk_sigma_mm < 0)
        light.fail_field("disk_sigma_mm", "is negative", "a standard deviation is 0 or greater");
    }
  }
  if (light.has("panel_mm")) {
    size.panel_mm = light.vec2("panel_mm");
    if (!(size.panel_mm.minCoeff() > 0))
      light.fail_field("panel_mm", "has a side that is not positive", "write the panel's two sides in mm");
    fail_if_too_large(light, "panel_mm", size.panel_mm.maxCoeff(), distance_mm);
    size.turn_deg = light.number("turn_deg", 0);
    if (light.has("panel_sigma_mm")) {
      size.panel_sigma_mm = light.vec2("panel_sigma_mm");
      if (size.panel_sigma_mm->minCoeff() < 0)
        light.fail_field("panel_sigma_mm", "is negative", "a standard deviation is 0 or greater");
    }
    if (light.has("turn_sigma_deg")) {
      size.turn_sigma_deg = light.number("turn_sigma_deg");
      if (*size.turn_sigma_deg < 0)
        light.fail_field("turn_sigma_deg", "is negative", "a standard deviation is 0 or greater");
    }
  }
  return size;
}

void put_lamp_size(const LampSize& size, Json& light) {
  if (size.disk_mm > 0) light["disk_mm"] = size.disk_mm;
  if (size.disk_sigma_mm) light["disk_sigma_mm"] = *size.disk_sigma_mm;
  if (!(size.panel_mm.maxCoeff() > 0)) return;
  light["panel_mm"] = {size.panel_mm.x(), size.panel_mm.y()};
  if (size.turn_deg != 0) light["turn_deg"] = size.turn_deg;
  if (size.panel_sigma_mm) light["panel_sigma_mm"] = {size.panel_sigma_mm->x(), size.panel_sigma_mm->y()};
  if (size.turn_sigma_deg) light["turn_sigma_deg"] = *size.turn_sigma_deg;
}

}  // namespace burin
