// burin/scene/board.h - the board as made, or its prior: size, tags, tool, material.
// Frame: board (origin at the lower-left corner of the face, x right, y up, z out of the metal), mm. docs/model.md 1
// and docs/file-formats.md.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/scene/bend.h"
#include "burin/scene/material.h"

namespace burin {

class JsonObject;

/// One AprilTag on the face. Its corners, as AprilTag reports them, form a square of side `size_mm`.
struct Tag {
  int id = 0;
  Eigen::Vector2d center_mm{0, 0};
  double size_mm = 0;
  double rotation_deg = 0;  ///< counter-clockwise; 0: upright for a viewer with x right and y up
  std::optional<Eigen::Vector2d> center_sigma_mm = {};  ///< of a measured tag, like rotation_sigma_deg
  std::optional<double> rotation_sigma_deg = {};
};

/// The tags on a board: their family, their paper, and the prior of their places.
struct TagSet {
  std::string family = "tagStandard41h12";
  double z_mm = 0.1;      ///< height of the tags' paper above the face
  double sigma_mm = 0.2;  ///< prior sigma of the tags' positions, per axis
  double white_albedo = 0.85;
  double black_albedo = 0.04;
  std::vector<Tag> list;
};

/// An area without grooves, such as a hole or a clamp: a circle or a simple polygon. The polygon's corners are in
/// order, in either sense of rotation; it may be concave.
struct KeepOut {
  std::string name;                         ///< for messages; may be empty
  std::vector<Eigen::Vector2d> polygon_mm;  ///< empty for a circle
  Eigen::Vector2d center_mm{0, 0};
  double radius_mm = 0;
  /// Height above the face; 0: nothing rises there (a hole). Nothing: unknown; no tool may then move over the sheet.
  std::optional<double> height_mm{};
};

/// `board.json`. docs/file-formats.md.
struct Board {
  Eigen::Vector2d size_mm{0, 0};
  Eigen::Vector2d carve_min_mm{0, 0}, carve_max_mm{0, 0};  ///< `carve_mm`: rectangle for scratches
  std::vector<KeepOut> keep_out;                           ///< a person's list; tag_paper() adds the tags' paper
  TagSet tags;
  std::filesystem::path scratches;  ///< absolute or relative to the working directory; empty if the file names none
  double tool_width_um = 400;       ///< w-tilde in Eqn. 2, fixed by the cutter's tip
  Material material;
  /// Unevenness of the face on the machine: its highest minus its lowest place over the carve area, um. A person
  /// measured or estimated it. Nothing: unknown.
  std::optional<double> flatness_um;
  SaidMaterial said;  ///< fields present in the source file
  /// Optional OBJ with uv for a board that is neither flat nor bowed; empty if none
  std::filesystem::path mesh;
  std::optional<Bend> bend;  ///< of a sheet bent to a cylinder after carving; not with a mesh
};

/// The four corners of a tag on the board, in AprilTag's order for an upright tag:
/// lower-left, lower-right, upper-right, upper-left. Board xy, mm.
std::array<Eigen::Vector2d, 4> tag_corners_mm(const Tag& tag);

/// The square of paper of a tag, with its white border (quiet zone), as a keep-out with the tag's name. Throws Error
/// for a family that AprilTag does not have.
KeepOut tag_paper(const Tag& tag, const std::string& family);

/// Reads the field `size_mm` of a board: width and height in mm. Throws Error if one is not above 0 or is beyond
/// docs/limits.md.
Eigen::Vector2d read_board_size(JsonObject& json);

/// Reads `board.json`. Throws Error on a missing or broken file, an unknown key, or a value out of range.
Board read_board(const std::filesystem::path& file);

/// Writes `board.json` atomically; paths become relative to the file's folder.
void write_board(const Board& board, const std::filesystem::path& file);

}  // namespace burin
