// burin/scene/far_light.h - light from so far away that it comes from the same directions everywhere on the board: the
// sun, and surroundings as a picture of all directions. docs/model.md 10. Frame: board.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>

#include "burin/base/image.h"
#include "burin/scene/light.h"

namespace burin {

/// How a latitude-longitude picture lies about the board. Its rows run from the direction `up` (row 0) to the opposite
/// one. `board`: up is +z, straight out of the face, and columns run by azimuth from +x counter-clockwise. `inside`:
/// the picture is a panorama as someone within sees it, turning right from column to column; its middle column looks
/// towards `middle` (as far as that is level), its top row towards `up`.
struct PanoramaFrame {
  enum class Kind { board, inside };
  Kind kind = Kind::board;
  Eigen::Vector3d up{0, 0, 1}, middle{-1, 0, 0};
};

/// Surroundings: radiance by direction, R G B, linear. Every pixel has one radiance all over.
struct Panorama {
  Image radiance;                                                 ///< 3 channels, none negative
  Eigen::Matrix3d R_picture_board = Eigen::Matrix3d::Identity();  ///< to the frame of rows and columns
  bool turns_right = false;                                       ///< columns run clockwise about that frame's z

  /// Direction (board, unit) of the place (column, row) of the picture, in pixels: the middle of the first is at 0.5.
  Eigen::Vector3d direction(double column, double row) const;
  /// The pixel that a direction (board) meets.
  std::size_t pixel(const Eigen::Vector3d& direction) const;
  /// Solid angle of each pixel of a row.
  double solid_angle(int row) const;
};

/// The sun or surroundings.
struct FarLight {
  // The sun:
  Eigen::Vector3d direction{0, 0, 1};  ///< to it, unit, board
  double diameter_deg = 0.53;          ///< as seen from the board
  // Surroundings:
  std::filesystem::path picture;  ///< empty where it was not read from a file
  PanoramaFrame frame;
  std::shared_ptr<const Panorama> surroundings;  ///< null: this is the sun

  bool is_sun() const { return surroundings == nullptr; }
};

/// How far away the stand-in of a far light lies (Light::position_mm).
inline constexpr double kFar_mm = 1e7;

/// A sun of that irradiance (R G B, on a plane that faces it).
Light sun_light(const Eigen::Vector3d& direction, const Eigen::Vector3d& irradiance, double diameter_deg = 0.53);

/// Surroundings; position_mm of what is returned lies where most of the light comes from above the face.
Light surroundings_light(std::shared_ptr<const Panorama> panorama, const Eigen::Vector3d& factor = {1, 1, 1});

/// A panorama of a picture in memory. Throws Error naming `where` for values that are negative or not finite, for a
/// picture that is not twice as wide as high (within a pixel), or of another number of channels than 1 and 3, for a
/// frame without directions, and for one that is black above the face.
std::shared_ptr<const Panorama> make_panorama(Image radiance, const PanoramaFrame& frame, const std::string& where);

/// The lamp that a sun acts like from where the board is: a point far away. docs/model.md 10.3.
Light sun_as_lamp(const Light& sun);

/// By how much the square of a roughness grows under a light of that angular diameter. docs/model.md 10.4.
double widening(double diameter_deg);

/// Irradiance of a plane with that normal, R G B, from the directions above it.
Eigen::Vector3d irradiance(const Panorama& panorama, const Eigen::Vector3d& normal);

}  // namespace burin
