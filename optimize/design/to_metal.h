// burin/optimize/design/to_metal.h - the bench of a design, and its scratches as carved grooves. Frame: board, mm.
// docs/model.md 7.
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

/// Depth or roughness of the field at a place, halfway through the carving.
inline double at_place(const GrooveField& field, double shared, const Eigen::Vector2d& board_size_mm,
                       const Eigen::Vector2d& p_mm) {
  return shared * field_over_board(field.terms, p_mm.x() / board_size_mm.x(), p_mm.y() / board_size_mm.y());
}

/// Bench and board of a design; both must outlive it.
struct Metal {
  const Bench& bench;
  const Board& board;

  Carved carved(const Scratches& designed) const { return carve(Designed(designed), bench, board); }

  /// Grooves of the middle age, one per scratch: depth and roughness depend on the place only. The search uses them.
  Carved carved_alone(const Scratches& designed) const;
};

/// Area of the grooves side by side, mm2. Width and depth are the board's and the bench's if the scratches have none.
double area_mm2(const Scratches& grooves, const Bench& bench, const Board& board);

/// The bench with additive crossings instead of cut rims (Crossings::deepest); else unchanged.
Bench adding_rims(Bench bench);

/// The bench without spatial variation of its grooves.
Bench without_fields(Bench bench);

/// Sums of a value per groove, such as its light, over the pieces of each designed row.
std::vector<double> by_design(const Carved& carved, const std::vector<double>& by_groove, std::size_t rows);

}  // namespace burin
