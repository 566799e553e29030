// tools/wall/wall_file.h - wall.json: boards that hang side by side and show pictures together (docs/file-formats.md).
//
//   WALL/wall.json            the wall: its boards, views, lamps and pictures
//   WALL/pictures/            the pictures, uncut
//   WALL/laid.json            from which wall.json the boards were laid out, and the exposures of the previews
//   WALL/BOARD/               an ordinary loop project for each board
//   WALL/previews/BOARD.json  preview of a board, for the couplings
//   WALL/settled.json         the couplings: one exposure per view, scratches of each board
//   WALL/claims/              who does what (tools/wall/claim.h)
//
// Frame: wall (x right, y up, z towards the eyes, origin at the lower left corner of all boards together), mm. A
// board's own frame is parallel to it.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "burin/base/files/json_file.h"
#include "burin/optimize/design_file.h"
#include "burin/scene/board.h"

namespace burin {

struct WallBoard {
  std::string name;                 ///< of its folder; letters, digits, - and _
  Eigen::Vector2d corner_mm{0, 0};  ///< its lower left corner
  Eigen::Vector2d size_mm{0, 0};
  std::string machine;  ///< a built-in name, or a file relative to the wall
};

struct WallView {
  std::string name, light = "lamp";
  Eigen::Vector3d eye_mm{0, 0, 0};
  std::filesystem::path picture;  ///< resolved
  Fit fit = Fit::cover;
  Keep keep = Keep::middle;
  double weight = 1;
};

struct Wall {
  std::filesystem::path folder;
  int scratches = 0;         ///< of all boards together
  double machine_hours = 0;  ///< or of all machines together; 0: `scratches` counts
  double tag_mm = 0;         ///< side of the tags on each board; 0: none, and `border_mm` counts
  double border_mm = 0;      ///< from a board's edge to its carve area, without tags
  double depth_um = 14, face_alpha = 0.1;
  Json camera;    ///< as in bench.json
  Json lights;    ///< as in bench.json, in the wall's frame
  Json material;  ///< as in bench.json; null without
  std::vector<WallView> views;
  std::vector<WallBoard> boards;
};

/// Reads WALL/wall.json. Throws Error with file and field.
Wall read_wall(const std::filesystem::path& folder);

/// Writes WALL/wall.json.
void write_wall(const Wall& wall);

/// SHA-256 of WALL/wall.json. It identifies the wall in all files made from it.
std::string wall_key(const std::filesystem::path& folder);

/// The board as a project has it: tags, carve area and material. Tags are numbered on from board to board.
Board board_of(const Wall& wall, std::size_t index);

/// Corners of the smallest rectangle around all carve areas.
struct WallArea {
  Eigen::Vector2d min_mm{0, 0}, max_mm{0, 0};
  Eigen::Vector2d size_mm() const { return max_mm - min_mm; }
};
WallArea area_of(const Wall& wall);

/// Size of a pixel of the wall's designs: what eyes at the mean distance resolve, or larger if there are too few
/// scratches to fill such pixels (docs/design.md, "How many pixels"), or to have at most 512 on a board.
double pitch_of(const Wall& wall);

/// Pixels along the longer side of a board's carve area.
int pixels_of(const Board& board, double pitch_mm);

/// A grid of equal boards; the name of the upper left one is r1c1.
std::vector<WallBoard> grid_of_boards(int columns, int rows, const Eigen::Vector2d& board_mm, double gap_mm);

/// Boards from the <rect> elements of an SVG. A width of the drawing in mm, cm or in sets the scale; otherwise one unit
/// is one mm. Names are the ids, or b1, b2, ... Throws Error for other shapes' transforms, and for no rectangle.
std::vector<WallBoard> boards_of_drawing(const std::filesystem::path& svg);

/// Throws Error, with `where`, for boards that overlap, equal names and names that are no folder's.
void check_boards(const std::vector<WallBoard>& boards, const std::string& where);

}  // namespace burin
