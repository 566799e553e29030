// tools/sheet/bench_drawing.h - drawing to scale of lamps and eyes, projected along one axis. Each place has its
// tolerance as an ellipse (outline of the ellipsoid of PlaceTolerance) and a label that covers nothing.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "burin/optimize/design/tolerance.h"
#include "burin/scene/board.h"
#include "tools/drawing/drawing.h"

namespace burin {

/// One lamp or eye. Board frame, mm.
struct SheetPlace {
  std::string label;  ///< short: "1", "L"
  std::string name;   ///< as in design.json
  bool lamp = false;
  Eigen::Vector3d at_mm{0, 0, 0};
  PlaceTolerance tolerance;
};

/// Direction of projection and place of the board: flat on a table with its lower edge in front, or on a wall.
enum class Projection {
  table_above,  ///< x right, y up on the page
  table_front,  ///< from the lower edge: x right, height up
  wall_front,   ///< from the front: x right, y up
  wall_above,   ///< x right, the wall at the top
  wall_side,    ///< from the left: the wall at the left, distance from it to the right, y up, with the floor
};

struct BenchDrawing {
  Drawing drawing;
  double scale = 1;                     ///< mm on paper per mm
  std::vector<Eigen::Vector2d> places;  ///< on the drawing, in the order of the places
};

/// Fits everything into a drawing of the given width. The height follows, up to `most_height_mm`. `text_mm`: size of
/// the labels. `hang_height_mm`: height of the board's center above the floor, for wall_side.
BenchDrawing bench_drawing(const Board& board, const std::vector<SheetPlace>& places, Projection projection,
                           double width_mm, double most_height_mm, double text_mm, double hang_height_mm);

/// Projected outline of a place's tolerance: points relative to the place, right and up, mm on the bench.
std::vector<Eigen::Vector2d> tolerance_outline(const Board& board, const SheetPlace& place, Projection projection);

}  // namespace burin
