#include "burin/scene/files/camera_json.h"

#include <cmath>
#include <string>

#include "burin/base/files/input_file.h"
#include "burin/base/image.h"
#include "burin/base/limits.h"
#include "burin/scene/look_at.h"

namespace burin {
namespace {

Eigen::Isometry3d rigid_motion(JsonObject& json, const std::string& key) {
  const Eigen::Matrix4d m = json.matrix(key, 4, 4);
  const Eigen::Matrix3d R = m.topLeftCorner<3, 3>();
  constexpr double kTolerance = 1e-6;  // rounding of a person's 7 digits; 1 um at a meter
  if ((m.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() > kTolerance)
    json.fail_field(key, "its last row is not [0, 0, 0, 1]", "write a 4x4 rigid motion, row by row");
  if ((R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > kTolerance || R.determinant() < 0)
    json.fail_field(key, "is not a rigid motion: its upper left 3x3 is no rotation",
                    "write orthonormal axes with determinant +1, to at least 7 digits");
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.matrix().topRows<3>() = m.topRows<3>();
  return T;
}

}  // namespace

Eigen::Isometry3d aimed_at(const Eigen::Isometry3d& pose, const Eigen::Vector3d& aim_mm, double roll_deg) {
  return look_at(pose.inverse().translation(), aim_mm, roll_deg);
}

SaidPose read_pose(JsonObject& json) {
  const bool eye = json.has("eye_mm"), aim = json.has("aim_mm"), roll = json.has("roll_deg");
  const std::string how =
      "write eye_mm, [x, y, z] of the camera in mm from the board's lower left corner, z out of the metal; aim_mm (the "
      "board's middle if left out) and roll_deg (0) may go with it";
  if (json.has("T_camera_board")) {
    if (eye || aim || roll)
      json.fail_field("T_camera_board",
                      std::string("and ") +
                          (eye   ? "eye_mm"
                           : aim ? "aim_mm"
                                 : "roll_deg") +
                          " both give the camera's place",
                      "keep one of them");
    return {rigid_motion(json, "T_camera_board"), std::nullopt};
  }
  if (!eye) json.fail_field("eye_mm", "is missing", how);
  const Eigen::Vector3d at = json.vec3("eye_mm");
  if (!(at.z() > 0)) json.fail_field("eye_mm", "is " + to_json(at).dump() + ", behind the board's face", how);
  const double roll_deg = json.number("roll_deg", 0);
  if (!aim) {
    const Eigen::Vector3d below(at.x(), at.y(), 0);
    return {look_at(at, below, roll_deg), roll_deg};
  }
  const Eigen::Vector3d to = json.vec3("aim_mm");
  if (!(to.z() < at.z()))
    json.fail_field(
        "aim_mm",
        "is " + to_json(to).dump() + (to == at ? ", where the eye is" : ": the camera looks away from the board"),
        "write a place on the board or near it, as [100, 75, 0]");
  return {look_at(at, to, roll_deg), std::nullopt};
}

Lens read_nominal_lens(JsonObject& json) {
  const double focal_35mm = json.positive("focal_35mm");
  constexpr double kWidest = 3, kLongest = 3000;
  if (focal_35mm < kWidest || focal_35mm > kLongest)
    json.fail_field("focal_35mm", "is " + Json(focal_35mm).dump(),
                    "write the focal length that gives the same view on 24 x 36 mm film: 26 for most phones");
  const std::vector<double> pixels = json.numbers("pixels", 2);
  for (const double v : pixels)
    if (!(v >= 16 && v <= 1e5 && v == std::floor(v)))
      json.fail_field("pixels", "is " + json.raw("pixels").dump(), "write width and height of a photo in whole pixels");
  require_picture_size(static_cast<std::int64_t>(pixels[0]), static_cast<std::int64_t>(pixels[1]), limit::kPhotoPixels,
                       json.where() + ": pixels", "a photo");
  return nominal_lens(focal_35mm, static_cast<int>(pixels[0]), static_cast<int>(pixels[1]));
}

}  // namespace burin
