// burin/calib/verdict/camera_place.h - possible places of camera and lamp for a future photo.
// Frame: board, mm.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/lens.h"

namespace burin {

/// A possible viewpoint, aimed at the board's middle.
struct CameraPlace {
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
  std::size_t direction = 0;  ///< viewpoints with one direction differ in distance and roll
  double distance_mm = 0;     ///< from the board's middle
  double tilt_rad = 0;        ///< of the line of sight from the board's normal
  double azimuth_rad = 0;     ///< of the camera about the board's middle, counter-clockwise from x
  double roll_rad = 0;        ///< 0: upright; pi / 2: on its side

  /// The camera's center in the board's frame.
  Eigen::Vector3d center_mm() const { return T_camera_board.inverse().translation(); }
};

/// Distances from the board's middle with a sharp photo at one focus setting, mm. Focusing changes the lens.
struct FocusRange {
  double near_mm = 0, far_mm = 0;

  /// True if the distance is within the range.
  bool holds(double distance_mm) const { return distance_mm >= near_mm && distance_mm <= far_mm; }
};

/// Sharp range at f/8 with the lens focused at that distance: a blur below 1/1200 of the picture's width (0.03 mm on 36
/// mm). Pixels do not give the sensor's size: the function assumes a width of 36 mm, and smaller sensors have a larger
/// range. The far end is at most three times the focus. Thin lens: the blur is A f (1/d - 1/s), with A the aperture.
FocusRange depth_of_field(const Lens& lens, double focus_mm);

/// Viewpoints on a hemisphere, from straight above to 65 degrees to the side, in up to 37 directions. In each
/// direction, the nearest viewpoint that sees the whole board. With `variants`, also one at 1.5 times the distance, and
/// the nearest one with the camera on its side. `focus` restricts the distances: the nearest viewpoint is at its near
/// end and the variant at its far end. Directions that see the whole board only from further away are dropped, perhaps
/// all of them. Throws Error if the lens sees the whole board from nowhere within 100 times its size.
std::vector<CameraPlace> camera_places(const Board& board, const Lens& lens, bool variants,
                                       const std::optional<FocusRange>& focus = {});

/// The viewpoint of an upright camera at that point, aimed at the board's middle. Throws Error for a point that is not
/// in front of the board.
CameraPlace camera_place_at(const Eigen::Vector3d& center_mm, const Board& board, std::size_t direction);

/// "620 mm above the face, 240 mm beyond the left edge, 60 mm in from the lower edge".
std::string place_in_words(const Eigen::Vector3d& p_board_mm, const Board& board);

/// place_in_words() of a camera, with its aim: "..., aimed at the middle (35 degrees from straight down)".
std::string place_in_words(const CameraPlace& place, const Board& board);

/// True if the camera would block the lamp's light, or the lamp the camera's sight: one is within the cone from the
/// other to the board. Both have the size of a hand (70 mm around their middle).
bool in_the_way(const Eigen::Vector3d& camera_mm, const Eigen::Vector3d& lamp_mm, const Board& board);

/// The lamp rotated about the board's middle, by each of these angles (degrees, counter-clockwise); names contain the
/// angle.
std::vector<Light> turned_lamps(const Light& light, const Board& board, const std::vector<double>& angles_deg);

/// Settings of a predicted photo (burin/calib/verdict/candidate_photo.h).
struct LightCandidateOptions {
  double pixel_mm = 1.6;     ///< size of the rendered pixels (the camera's are smaller)
  double model_error = 0.1;  ///< relative model error of such a pixel
  double noise = 1e-3;       ///< of a pixel, as a fraction of white paper's value
};

}  // namespace burin
