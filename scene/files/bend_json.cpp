#include "burin/scene/files/bend_json.h"

namespace burin {

Bend read_bend(JsonObject json, const std::optional<Eigen::Vector2d>& size_mm) {
  Bend bend;
  bend.radius_mm = json.number("radius_mm");
  bend.axis_deg = json.number("axis_deg", 0);
  // Without a size, only values invalid for every sheet are faults.
  if (const auto fault = fault_of(bend, size_mm.value_or(Eigen::Vector2d(1e-6, 1e-6))))
    json.fail_field(fault->field, fault->what, fault->remedy);
  json.finish();
  return bend;
}

Bend read_bend_sigma(JsonObject json) {
  const Bend sigma{json.number("radius_mm"), json.number("axis_deg", 0)};
  if (sigma.radius_mm < 0) json.fail_field("radius_mm", "is negative", "write an uncertainty of 0 or more");
  if (sigma.axis_deg < 0) json.fail_field("axis_deg", "is negative", "write an uncertainty of 0 or more");
  json.finish();
  return sigma;
}

Json bend_json(const Bend& bend) { return {{"radius_mm", bend.radius_mm}, {"axis_deg", bend.axis_deg}}; }

}  // namespace burin
