// burin/optimize/design/to_metal.h - the bench on which a design will be carved, and its scratches as they will lie
// there. Frame: board, mm. docs/model.md 7.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/carve.h"
#include "burin/scene/groove_field.h"
#include "burin/scene/scratches.h"

namespace burin {

/// A depth or roughness that the field gives at a place, halfway through the carving.
inline double at_place(const GrooveField& field, double shared, const Eigen::Vector2d& board_size_mm,
                       const Eigen::Vector2d& p_mm) {
  return shared * field_over_board(field.terms, p_mm.x() / board_size_mm.x(), p_mm.y() / board_size_mm.y());
}

/// Where a design is carved; both must outlive it.
struct Metal {
  const Bench& bench;
  const Board& board;

  Carved carved(const Scratches& designed) const { return carve(Designed(designed), bench, board); }

  /// Scratches of the middle age, one by one: their depth and roughness follow the place only. What a search sees.
  Carved carved_alone(const Scratches& designed) const;
};

/// What grooves would cover of the metal side by side, mm2. Width and depth are the board's and the bench's where the
/// scratches have none.
double area_mm2(const Scratches& grooves, const Bench& bench, const Board& board);

/// The bench with grooves that add where they cut each other's rims away (Crossings::deepest); else as it is.
Bench adding_rims(Bench bench);

/// The bench with grooves that are all alike.
Bench without_fields(Bench bench);

/// A number for each groove, such as its light, added up for each designed row that grooves are pieces of.
std::vector<double> by_design(const Carved& carved, const std::vector<double>& by_groove, std::size_t rows);

}  // namespace burin
