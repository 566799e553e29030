// burin/calib/verdict/camera_place.h - where a camera and a lamp could stand for a photo that nobody took yet.
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

/// Where a camera could stand, looking at the board's middle.
struct CameraPlace {
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
  std::size_t direction = 0;  ///< places of one direction differ in distance and roll
  double distance_mm = 0;     ///< from the board's middle
  double tilt_rad = 0;        ///< of the line of sight from the board's normal
  double azimuth_rad = 0;     ///< of the camera about the board's middle, counter-clockwise from x
  double roll_rad = 0;        ///< 0: upright; pi / 2: on its side

  Eigen::Vector3d center_mm() const { return T_camera_board.inverse().translation(); }
};

/// Distances from the board's middle at which a photo is sharp with one focus, mm: a lens that is focused anew is
/// another lens.
struct FocusRange {
  double near_mm = 0, far_mm = 0;

  bool holds(double distance_mm) const { return distance_mm >= near_mm && distance_mm <= far_mm; }
};

/// What is sharp at f/8 with the lens focused at that distance: what blurs by less than a 1200th of the picture's width
/// (0.03 mm on 36 mm). Pixels do not say how large a sensor is: it is taken for 36 mm wide, and a smaller one is sharp
/// further around. Never further than three times the focus. Thin lens: the blur is A f (1/d - 1/s), A the aperture.
FocusRange depth_of_field(const Lens& lens, double focus_mm);

/// Places on a hemisphere, in `directions` at most: from straight above to 65 degrees to the side. In each, the nearest
/// from which the lens sees the whole board; and, with `variants`, one half as far again, and the nearest with the
/// camera on its side. With `focus`, none lies outside of it: the nearest is at its near end, the variant at its far
/// end, and directions from which the board is seen whole only from further away are left out (perhaps all of them).
/// Throws Error if the lens sees the whole board from nowhere within 100 times its size.
std::vector<CameraPlace> camera_places(const Board& board, const Lens& lens, bool variants,
                                       const std::optional<FocusRange>& focus = {});

/// The place of a camera that stands there, upright, and looks at the board's middle. Throws Error for one that does
/// not stand in front of the board.
CameraPlace camera_place_at(const Eigen::Vector3d& center_mm, const Board& board, std::size_t direction);

/// "620 mm above the face, 240 mm beyond the left edge, 60 mm in from the lower edge".
std::string place_in_words(const Eigen::Vector3d& p_board_mm, const Board& board);

/// The same for a camera, with where it looks: "..., aimed at the middle (35 degrees from straight down)".
std::string place_in_words(const CameraPlace& place, const Board& board);

/// Whether a camera there would stand in the lamp's light, or the lamp in the camera's sight: either within the cone
/// from the other to the board, both being as large as a hand (70 mm about their middle).
bool in_the_way(const Eigen::Vector3d& camera_mm, const Eigen::Vector3d& lamp_mm, const Board& board);

/// The lamp turned about the board's middle, by each of these angles (degrees, counter-clockwise), named after them.
std::vector<Light> turned_lamps(const Light& light, const Board& board, const std::vector<double>& angles_deg);

/// How a photo from there is imagined (burin/calib/verdict/candidate_photo.h).
struct LightCandidateOptions {
  double pixel_mm = 1.6;     ///< size of the pixels that are rendered (those of the camera are smaller)
  double model_error = 0.1;  ///< relative, of such a pixel: what the model misses
  double noise = 1e-3;       ///< of a pixel, as a share of white paper's value
};

}  // namespace burin
