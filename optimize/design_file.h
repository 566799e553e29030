// burin/optimize/design_file.h - a request for a design: `design.json`. docs/file-formats.md.
//
//   { "format": "burin/design", "version": 1, "board": "board.json", "bench": "bench.json", "scratches": 40000,
//     "views": [ { "view": "v00", "light": "lamp", "target": "cat.png", "rotation_deg": 0 } ] }
//
// Optional keys of a view:
//   "fit"      "cover" (default) or "contain"
//   "keep"     "top", "bottom", "left", "right" or "middle"
//   "levels"   [black, white]
//   "mask"     a file such as "cat-mask.png"
//   "weight"   factor of its errors (default 1)
//   "lights"   ["sun", "room"] instead of "light", if several lights shine at once
//   "color"    true: the picture in color, by lights of different colors at different places
//   "white"    of a picture in color, the white reference: "paper" (default), "each" or a light [r, g, b]
//   "exposure" factor from radiance to light, 1 at white: fixed instead of chosen by the design
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/image.h"

namespace burin {

/// Placement of a picture whose shape differs from the carve area's: `cover` fills the area and crops the rest,
/// `contain` shows the whole picture on black.
enum class Fit { cover, contain };

/// The edge kept by `cover` in a cropped picture, in the picture's own frame. `top` and `bottom` have no effect on a
/// picture that loses width, `left` and `right` none on a picture that loses height.
enum class Keep { middle, top, bottom, left, right };

/// "middle", "top", ..., as in design.json.
const char* keep_name(Keep keep);
/// The inverse of keep_name; nothing for any other text.
std::optional<Keep> keep_named(const std::string& name);

/// A picture and its placement on the board.
struct TargetSpec {
  std::filesystem::path picture;
  Image image{};  ///< the picture itself, if it has pixels: one or three channels, 0 to 1, sRGB-encoded as in a PNG
  double rotation_deg = 0;       ///< counter-clockwise, seen with x right and y up
  bool upright_in_view = false;  ///< "rotation_deg": "viewer": upright in this view's photo instead
  Fit fit = Fit::cover;
  std::optional<Keep> keep;                     ///< nothing: the middle, and the loader reports the crop
  std::optional<std::array<double, 2>> levels;  ///< gamma-encoded values that become black and white
  std::filesystem::path mask;  ///< picture with white in the valid pixels and black elsewhere; empty: all valid
  Image mask_image{};          ///< the mask itself, if it has pixels; as `image`
  bool may_be_even = false;    ///< it may be of one tone: a part of a larger picture, at a fixed exposure
};

/// The white reference of a picture in color, for an eye or a camera.
struct White {
  /// `paper`: white paper on the board under all the view's lights. `light`: light of the color `rgb` (a camera with a
  /// fixed balance). `each`: each channel has a brightness of its own, as in a camera whose balance is adjusted for the
  /// best picture.
  enum class Kind { paper, light, each };
  Kind kind = Kind::paper;
  Eigen::Vector3d rgb{1, 1, 1};
};

/// One picture that the board is to show.
struct DesignView {
  std::string view;            ///< name in bench.json
  std::string light = "lamp";  ///< id in bench.json, or several joined by kBesides (burin/scene/bench.h)
  TargetSpec target;
  double weight = 1;  ///< of this view's loss
  /// The target is shown in color: each scratch reflects the color of one of the lights. Else it is shown as luminance.
  bool color = false;
  White white{};
  /// Factor from radiance to light, 1 at white. Boards that are seen together have one. Nothing: the design chooses it.
  std::optional<double> exposure{};
};

/// A requested design (`design.json`).
struct DesignSpec {
  std::filesystem::path board, bench;  ///< absolute, or relative to the working directory
  int scratches = 0;                   ///< initial number; pruning removes weak ones at the end
  std::vector<DesignView> views;
};

/// Reads `design.json`. Throws Error naming file and field for a missing, unknown or invalid entry.
DesignSpec read_design(const std::filesystem::path& file);

/// Writes `design.json` atomically, with paths relative to the file's folder. Throws Error for a target that is only in
/// memory.
void write_design(const DesignSpec& spec, const std::filesystem::path& file);

}  // namespace burin
