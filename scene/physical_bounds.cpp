#include "burin/scene/physical_bounds.h"

#include "burin/base/error.h"
#include "burin/base/files/decimals.h"
#include "burin/base/files/json_file.h"

namespace burin {

double require_within(const JsonObject& json, const std::string& key, double value, double least, double most,
                      std::string_view unit) {
  if (!(value >= least && value <= most))
    json.fail_field(key, "is " + Json(value).dump(),
                    "write " + shortest(least) + " to " + shortest(most) + " " + std::string(unit));
  return value;
}

double read_depth_um(JsonObject& json, const std::string& key, std::optional<double> fallback) {
  const double depth_um = fallback ? json.positive(key, *fallback) : json.positive(key);
  if (depth_um > bound::kDepth_um || depth_um < bound::kShallowest_um)
    json.fail_field(key,
                    "is " + Json(depth_um).dump() + " um, " +
                        (depth_um > bound::kDepth_um ? "deeper than any tip cuts" : "too shallow to be a groove"),
                    "write micrometers, " + shortest(bound::kShallowest_um) + " to " + shortest(bound::kDepth_um));
  return depth_um;
}

double read_tool_width_um(JsonObject& json, const std::string& key, std::optional<double> fallback) {
  const double width_um = fallback ? json.positive(key, *fallback) : json.positive(key);
  if (width_um > bound::kToolWidth_um)
    json.fail_field(key, "is " + Json(width_um).dump() + " um, wider than any tip",
                    "write four times the tip's radius in micrometers, at most " + shortest(bound::kToolWidth_um));
  return width_um;
}

Eigen::Vector3d read_bow_mm(JsonObject& json, const std::string& key) {
  Eigen::Vector3d bow_mm = json.vec3(key, Eigen::Vector3d::Zero());
  if (!(bow_mm.cwiseAbs().maxCoeff() <= bound::kBow_mm))
    json.fail_field(key, "is " + to_json(bow_mm).dump() + ", more than any sheet bows",
                    "write millimeters, at most " + shortest(bound::kBow_mm) + " each");
  return bow_mm;
}

void fail_unless_bow_fits(const Eigen::Vector3d& bow_mm, const Eigen::Vector2d& size_mm, const std::string& where) {
  const double most_mm = bound::kBowShare * size_mm.minCoeff();
  if (!(bow_mm.cwiseAbs().maxCoeff() <= most_mm))
    fail(where,
         "has a bow of " + significant(bow_mm.cwiseAbs().maxCoeff(), 3) + " mm, and a sheet of " +
             shortest(size_mm.x()) + " x " + shortest(size_mm.y()) + " mm that a tool follows bows by at most " +
             significant(most_mm, 3) + " mm",
         "measure the bench again, or probe the sheet and give --heights instead");
}

}  // namespace burin
