// tools/new/words.h - sizes, lamps and cameras as people say them: "1.2m", "8x6in", "above 600mm", "phone".
// Frame: board, mm.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/scene/lens.h"

namespace burin {

/// A length in mm: "1.2m", "48in", "60cm", "600mm", "600" (mm). Throws Error for anything else, and for 0 and less.
/// `what` is named in the message.
/// The files of a line as a person types it or a terminal drops it: parted by spaces or commas, unless quotes or
/// backslashes hold them together; ~ is the home folder, file:// addresses are names.
std::vector<std::string> files_in_words(const std::string& line);

/// The same of one file, whose name may have spaces all the same.
std::string file_in_words(const std::string& line);

double length_in_words(const std::string& text, const std::string& what);

/// Width and height in mm: "200x150", "20x15cm", "8x6in", "20cm x 15cm". Throws Error for anything else.
Eigen::Vector2d size_in_words(const std::string& text, const std::string& what);

/// Where a lamp is, as it was said.
struct SaidLamp {
  std::optional<Eigen::Vector3d> position_mm;  ///< "100,-300,450"
  double azimuth_deg = 90;                     ///< else: in which direction from the board's middle, counter-clockwise
                                               ///< from x; 90: beyond the upper edge
  double distance_mm = 0;                      ///< from the middle; 0: not said
};

/// "above", "left 800mm", "above right 60cm", or X,Y,Z in mm. Throws Error for anything else, and for a place behind
/// the face.
SaidLamp lamp_in_words(const std::string& text);

/// Where that is: at the said place, or in the said direction, 40 degrees from the board's normal, `usual_mm` from the
/// middle where no distance was said.
Eigen::Vector3d lamp_position_mm(const SaidLamp& said, const Eigen::Vector2d& board_mm, double usual_mm);

/// A camera, and how bench.json says it.
struct SaidCamera {
  Lens lens;
  double focal_35mm = 0;              ///< of a camera in words
  std::filesystem::path cameramodel;  ///< of a lens that was calibrated: a copy of this; empty otherwise
  std::string in_words;               ///< "a phone: 26 mm as on film, 4032 x 3024 pixels"
};

/// "phone", a focal length on film ("50mm"), a photo with EXIF, or a `.cameramodel`. Throws Error for a photo that does
/// not say its focal length, with what to give instead.
SaidCamera camera_in_words(const std::string& text);

}  // namespace burin
