// burin/scene/files/camera_json.h - poses and lenses as people write them into bench.json and truth.json.
// docs/file-formats.md. Include it in .cpp files only: it pulls in nlohmann-json.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "burin/base/files/json_file.h"
#include "burin/scene/lens.h"

namespace burin {

/// A camera's pose from a file. Frame: board, mm.
struct SaidPose {
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
  /// Set if the file gives only an eye. The camera looks at the board's middle, turned by this angle. T_camera_board
  /// has its center, but looks straight down.
  std::optional<double> roll_to_middle_deg;
};

/// Reads `T_camera_board`, or `eye_mm` with or without `aim_mm` and `roll_deg`. Throws Error if both or neither are
/// there, the matrix is no rigid motion, the eye is behind the face, or the camera looks away from the board.
SaidPose read_pose(JsonObject& json);

/// A pose at the center of `pose` that looks at a place of the board, turned by `roll_deg`.
Eigen::Isometry3d aimed_at(const Eigen::Isometry3d& pose, const Eigen::Vector3d& aim_mm, double roll_deg);

/// Reads `focal_35mm` and `pixels` (width, height) as a lens without distortion (nominal_lens). Throws Error for values
/// that no camera has.
Lens read_nominal_lens(JsonObject& json);

}  // namespace burin
