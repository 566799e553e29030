#include "burin/scene/files/machine_json.h"

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <optional>

#include "burin/scene/physical_bounds.h"

namespace burin {

MachineErrors read_machine_errors(JsonObject& json) {
  MachineErrors errors;
  const auto sigma = [&](const char* key) -> std::optional<Eigen::Vector2d> {
    if (!json.has(key)) return std::nullopt;
    const Eigen::Vector2d v = json.vec2(key);
    if ((v.array() < 0).any()) json.fail_field(key, "has a negative entry", "standard deviations are 0 or greater");
    return v;
  };
  if (json.has("backlash_mm")) errors.backlash_mm = json.vec2("backlash_mm");
  if (!((errors.backlash_mm.array() >= 0).all() && (errors.backlash_mm.array() <= bound::kBacklash_mm).all()))
    json.fail_field("backlash_mm", "is " + to_json(errors.backlash_mm).dump(),
                    "write how far each axis lags after it turns, 0 to 1 mm");
  errors.backlash_sigma_mm = sigma("backlash_sigma_mm");
  if (json.has("screw_mm")) {
    const Eigen::Vector2d amplitude = json.vec2("screw_mm"), period = json.vec2("screw_period_mm"),
                          phase = json.vec2("screw_phase_deg") * (std::numbers::pi / 180);
    if (!(period.array() > 0).all() || !(period.array() <= bound::kScrewPeriod_mm).all())
      json.fail_field("screw_period_mm", "is " + to_json(period).dump(),
                      "write how far an axis moves in one turn of its screw, above 0 and up to 100 mm");
    if (!(amplitude.cwiseAbs().maxCoeff() <= bound::kScrew_mm))
      json.fail_field("screw_mm", "is " + to_json(amplitude).dump(), "write amplitudes of some hundredths of a mm");
    // largest derivative of the error by the command; above 1, the tool would move backwards
    constexpr double kSteepest = 0.5;
    if ((amplitude.array().abs() * (2 * std::numbers::pi) > kSteepest * period.array()).any())
      json.fail_field("screw_mm", "is too large for screw_period_mm", "write amplitudes of some hundredths of a mm");
    errors.screw_period_mm = period;
    errors.screw_sin_mm = amplitude.array() * phase.array().cos();
    errors.screw_cos_mm = amplitude.array() * phase.array().sin();
    errors.screw_sigma_mm = sigma("screw_sigma_mm");
  }
  return errors;
}

Eigen::Matrix<double, 2, 3> read_machine_affine(JsonObject& json, const Eigen::Matrix<double, 2, 3>& otherwise) {
  if (!json.has("affine")) return otherwise;
  Eigen::Matrix<double, 2, 3> affine = json.matrix("affine", 2, 3);
  if (std::abs(affine.leftCols<2>().determinant()) < 1e-9)
    json.fail_field("affine", "its determinant is 0: it flattens the board to a line",
                    "write [[1, 0, 0], [0, 1, 0]] if the machine's error is not known");
  const double off = (affine.leftCols<2>() - Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= bound::kMapShare && affine.col(2).cwiseAbs().maxCoeff() <= bound::kMapShift_mm))
    json.fail_field("affine",
                    "is " + to_json(affine).dump() + ", farther from [[1, 0, 0], [0, 1, 0]] than a machine is",
                    "write numbers within 0.05 of these, and shifts of at most 10 mm");
  return affine;
}

Json machine_json(const Eigen::Matrix<double, 2, 3>& affine, const MachineErrors& errors) {
  Json json;
  json["affine"] = to_json(affine);
  if (!errors.backlash_mm.isZero(0)) {
    json["backlash_mm"] = to_json(errors.backlash_mm);
    if (errors.backlash_sigma_mm) json["backlash_sigma_mm"] = to_json(*errors.backlash_sigma_mm);
  }
  if (errors.uneven()) {
    json["screw_mm"] = to_json(errors.screw_mm());
    if (errors.screw_sigma_mm) json["screw_sigma_mm"] = to_json(*errors.screw_sigma_mm);
    json["screw_period_mm"] = to_json(errors.screw_period_mm);
    json["screw_phase_deg"] = to_json(errors.screw_phase_deg());
  }
  return json;
}

}  // namespace burin
