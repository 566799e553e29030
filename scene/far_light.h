// burin/scene/far_light.h - distant light, with the same directions everywhere on the board: the sun, and environment
// maps (surroundings). docs/model.md 10.
// Frame: board.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>

#include "burin/base/image.h"
#include "burin/scene/light.h"

namespace burin {

/// Orientation of a latitude-longitude picture. Rows run from the direction `up` (row 0) to the opposite one. `board`:
/// up is +z, straight out of the face, and columns run by azimuth from +x counter-clockwise. `inside`: the picture is a
/// panorama seen from within; columns turn to the right. Its middle column looks towards `middle` (projected to the
/// horizontal), its top row towards `up`.
struct PanoramaFrame {
  /// Frame of a panorama: the board's, or directions inside a room.
  enum class Kind { board, inside };
  Kind kind = Kind::board;
  Eigen::Vector3d up{0, 0, 1}, middle{-1, 0, 0};
};

/// Environment map: radiance by direction, R G B, linear. Radiance is constant over each pixel.
struct Panorama {
  Image radiance;                                                 ///< 3 channels, none negative
  Eigen::Matrix3d R_picture_board = Eigen::Matrix3d::Identity();  ///< to the frame of rows and columns
  bool turns_right = false;                                       ///< columns run clockwise about this frame's z

  /// Direction (board, unit) of a place (column, row) of the picture, in pixels: the center of the first pixel is at
  /// 0.5.
  Eigen::Vector3d direction(double column, double row) const;
  /// The pixel of a direction (board).
  std::size_t pixel(const Eigen::Vector3d& direction) const;
  /// Solid angle of each pixel of a row.
  double solid_angle(int row) const;
};

/// The sun or surroundings.
struct FarLight {
  // Sun:
  Eigen::Vector3d direction{0, 0, 1};  ///< to it, unit, board
  double diameter_deg = 0.53;          ///< as seen from the board
  // Environment map:
  std::filesystem::path picture;  ///< empty if no file was read
  PanoramaFrame frame;
  std::shared_ptr<const Panorama> surroundings;  ///< null: this is the sun

  /// True for a sun, false for surroundings.
  bool is_sun() const { return surroundings == nullptr; }
};

/// Distance of the point that represents a distant light (Light::position_mm).
inline constexpr double kFar_mm = 1e7;

/// A sun with that irradiance (R G B, on a plane that faces it).
Light sun_light(const Eigen::Vector3d& direction, const Eigen::Vector3d& irradiance, double diameter_deg = 0.53);

/// An environment map as a light. Its position_mm is in the direction of most of the light above the face.
Light surroundings_light(std::shared_ptr<const Panorama> panorama, const Eigen::Vector3d& factor = {1, 1, 1});

/// Makes a panorama from a picture in memory. Throws Error with `where` for negative or non-finite values and for a
/// number of channels other than 1 and 3. Throws Error for a picture that is not twice as wide as high (within a
/// pixel). Throws Error for a frame without directions and for a picture that is black above the face.
std::shared_ptr<const Panorama> make_panorama(Image radiance, const PanoramaFrame& frame, const std::string& where);

/// The equivalent lamp of a sun: a point far away. docs/model.md 10.3.
Light sun_as_lamp(const Light& sun);

/// Increase of a squared roughness under a light of this angular diameter. docs/model.md 10.4.
double widening(double diameter_deg);

/// Irradiance of a plane with that normal, R G B, from the directions above it.
Eigen::Vector3d irradiance(const Panorama& panorama, const Eigen::Vector3d& normal);

}  // namespace burin
