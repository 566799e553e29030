// burin/optimize/design_file.h - what a person wants a board to show: `design.json`. docs/file-formats.md.
//
//   { "format": "burin/design", "version": 1, "board": "board.json", "bench": "bench.json", "scratches": 40000,
//     "views": [ { "view": "v00", "light": "lamp", "target": "cat.png", "rotation_deg": 0 } ] }
//
// A view may also say "fit": "cover" (default) or "contain", "keep": "top" (or "bottom", "left", "right", "middle"),
// "levels": [black, white], "mask": "cat-mask.png" and "weight": 2 (how much its errors count; default 1). Where
// several lights shine at once, "lights": ["sun", "room"] stands for "light". With "color": true the picture is shown
// in color by lights of different colors at different places; "white" then says what is to look white: "paper"
// (default), "each" or a light [r, g, b].
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/image.h"

namespace burin {

/// How a picture of another shape is laid on the carve area: `cover` fills it and crops what is left over, `contain`
/// shows all of the picture on black.
enum class Fit { cover, contain };

/// Which part of a picture `cover` keeps, where it crops: the edge that stays, in the picture's own frame. `top` and
/// `bottom` say nothing of a picture that loses width, `left` and `right` nothing of one that loses height.
enum class Keep { middle, top, bottom, left, right };

/// "middle", "top", ..., as design.json has them.
const char* keep_name(Keep keep);
/// The other way; nothing for any other text.
std::optional<Keep> keep_named(const std::string& name);

/// A picture and how it lies on the board.
struct TargetSpec {
  std::filesystem::path picture;
  Image image{};  ///< the picture itself, if it has pixels: one channel or three, 0 to 1, sRGB-encoded as in a PNG
  double rotation_deg = 0;       ///< counter-clockwise as one looks at the board with x right and y up
  bool upright_in_view = false;  ///< "rotation_deg": "viewer": upright in that view's photo instead
  Fit fit = Fit::cover;
  std::optional<Keep> keep;  ///< nothing: the middle, and whoever loads the picture is told what is cropped
  std::optional<std::array<double, 2>> levels;  ///< gamma-encoded values that become black and white
  std::filesystem::path mask;                   ///< picture of what matters (white) and what does not; empty: all
  Image mask_image{};                           ///< the mask itself, if it has pixels; as `image`
};

/// What looks white in a picture in color, to an eye or a camera.
struct White {
  /// `paper`: white paper that lies on the board under all the view's lights. `light`: light of the color `rgb` (a
  /// camera whose balance stays as it is). `each`: the channels have a brightness of their own each, as a camera's
  /// whose balance is turned until the picture looks best.
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
  /// The target is shown in color: each scratch throws the color of one of the lights. Else as luminance.
  bool color = false;
  White white{};
};

/// A design that is wanted (`design.json`).
struct DesignSpec {
  std::filesystem::path board, bench;  ///< absolute, or relative to the working directory
  int scratches = 0;                   ///< how many to start with; weak ones are dropped at the end
  std::vector<DesignView> views;
};

/// Reads `design.json`. Throws Error naming file and field for anything missing, unknown or out of range.
DesignSpec read_design(const std::filesystem::path& file);

/// Writes `design.json`, paths made relative to the file's folder; atomically. Throws Error for a target that is only
/// in memory.
void write_design(const DesignSpec& spec, const std::filesystem::path& file);

}  // namespace burin
