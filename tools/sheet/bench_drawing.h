// tools/sheet/bench_drawing.h - where lamps hang and eyes stand, drawn to scale as seen along one axis, each place with
// what it tolerates as an ellipse (the outline of the ellipsoid of PlaceTolerance) and a label that covers nothing.
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

/// From where one looks, and how the board lies: flat on a table, its lower edge towards one, or on a wall.
enum class Projection {
  table_above,  ///< x right, y up on the page
  table_front,  ///< from the lower edge: x right, height up
  wall_front,   ///< as one looks at it: x right, y up
  wall_above,   ///< x right, the wall at the top
  wall_side,    ///< from the left: the wall at the left, away from it to the right, y up, with the floor
};

struct BenchDrawing {
  Drawing drawing;
  double scale = 1;                     ///< mm on paper of a mm
  std::vector<Eigen::Vector2d> places;  ///< on the drawing, in the order of the places
};

/// Fits everything into a drawing so wide, whose height follows (up to `most_height_mm`). `text_mm`: size of the
/// labels. `hang_height_mm`: of the board's middle above the floor, for wall_side.
BenchDrawing bench_drawing(const Board& board, const std::vector<SheetPlace>& places, Projection projection,
                           double width_mm, double most_height_mm, double text_mm, double hang_height_mm);

/// Outline of what a place tolerates as seen in a projection: points about the place, right and up, mm of the bench.
std::vector<Eigen::Vector2d> tolerance_outline(const Board& board, const SheetPlace& place, Projection projection);

}  // namespace burin
