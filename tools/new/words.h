// tools/new/words.h - parsers for sizes, lamps and cameras in words: "1.2m", "8x6in", "above 600mm", "phone". Frame:
// board, mm.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/scene/lens.h"

namespace burin {

/// Splits a typed or dropped line into files. Spaces and commas separate names, unless quoted or escaped by
/// backslashes. ~ is the home folder, and file:// addresses are names.
std::vector<std::string> files_in_words(const std::string& line);

/// Like files_in_words() for a single file, whose name may contain spaces.
std::string file_in_words(const std::string& line);

/// Parses a length, returned in mm: "1.2m", "48in", "60cm", "600mm", "600" (mm). Throws Error, naming `what`, for other
/// text, and for 0 and less.
double length_in_words(const std::string& text, const std::string& what);

/// Parses width and height, returned in mm: "200x150", "20x15cm", "8x6in", "20cm x 15cm". Throws Error for other text.
Eigen::Vector2d size_in_words(const std::string& text, const std::string& what);

/// A lamp's place in the user's words.
struct SaidLamp {
  std::optional<Eigen::Vector3d> position_mm;  ///< "100,-300,450"
  /// Otherwise the direction from the board's center, counter-clockwise from x. 90: beyond the upper edge.
  double azimuth_deg = 90;
  double distance_mm = 0;  ///< from the center; 0: not given
};

/// Parses "above", "left 800mm", "above right 60cm", or X,Y,Z in mm. Throws Error for other text, and for a place
/// behind the face.
SaidLamp lamp_in_words(const std::string& text);

/// Returns the given position, or a position in the given direction, 40 degrees from the board's normal. `usual_mm` is
/// the default distance from the center.
Eigen::Vector3d lamp_position_mm(const SaidLamp& said, const Eigen::Vector2d& board_mm, double usual_mm);

/// A camera and its description for bench.json.
struct SaidCamera {
  Lens lens;
  double focal_35mm = 0;              ///< of a camera in words
  std::filesystem::path cameramodel;  ///< file of a calibrated lens, to be copied; otherwise empty
  std::string in_words;               ///< "a phone: 26 mm as on film, 4032 x 3024 pixels"
};

/// Parses "phone", a 35 mm equivalent focal length ("50mm"), a photo with EXIF, or a `.cameramodel`. Throws Error, with
/// an alternative, for a photo without focal length.
SaidCamera camera_in_words(const std::string& text);

}  // namespace burin
