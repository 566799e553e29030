// burin/scene/look_at.h - the pose of a camera from its eye and its aim.
// Frames: board in, T_camera_board out; mm. docs/file-formats.md, `eye_mm`.
#pragma once

#include <Eigen/Geometry>

namespace burin {

/// A camera at `eye_mm` whose line of sight goes through `aim_mm`. With a roll of 0 the board's y points up in the
/// picture as far as possible. A positive roll turns the camera clockwise, as seen by its holder. The two points must
/// differ, and the line between them must not run along the board's y axis.
Eigen::Isometry3d look_at(const Eigen::Vector3d& eye_mm, const Eigen::Vector3d& aim_mm, double roll_deg = 0);

}  // namespace burin
