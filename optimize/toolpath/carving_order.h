// burin/optimize/toolpath/carving_order.h - the order, and for each scratch the end to begin at, that keeps the tool's
// travel short.
//
// Travel is what the tool moves in the air: from where it starts to the first scratch, and from each scratch to the
// next. Each scratch may be carved from either end, so this is a traveling salesman's tour over the 2n ends in which
// the n scratches are edges that stay. Method: a greedy tour to the nearest end, over a grid; then 2-opt (Croes,
// Operations Research 6(6), 1958) and Or-opt (Or, 1976; runs of up to three scratches, either way round), both over
// lists of nearest ends with a work queue (Bentley, ORSA J. Computing 4(4), 1992), until no such move shortens it; then
// small random changes (a local double bridge; Johnson and McGeoch 1997), improved the same way and kept only if they
// shorten the whole. Frame: any plane, mm. Deterministic.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "burin/base/progress.h"
#include "burin/scene/bench.h"
#include "burin/scene/scratches.h"

namespace burin {

/// One scratch of the tour: which, and whether it is carved from its second end to its first.
struct CarvingStep {
  std::uint32_t scratch = 0;
  bool reversed = false;
};

/// Where the tool starts, and how hard a short way is looked for.
struct CarvingOrderOptions {
  Eigen::Vector2d start_mm{0, 0};  ///< where the tool waits before the first scratch
  bool return_to_start = false;    ///< whether the way back counts
  int kicks_per_scratch = 5;       ///< random changes tried; they shorten 5,000 scratches' way by 8 %, 60,000's by 1 %
  int neighbors = 12;              ///< nearest ends looked at for each end
  std::function<bool()> stop;      ///< true ends the search with the order found so far; may be empty
};

/// The order to carve in: every scratch once.
std::vector<CarvingStep> carving_order(const Scratches& scratches, const CarvingOrderOptions& options = {},
                                       const Progress& progress = {});

/// Whether on this bench the order of carving shows: its tool wears, or the groove carved last rules where grooves
/// cross. Then a board must be carved in the order that it was designed for.
bool order_matters(const Bench& bench);

/// The scratches as they are in the file: first to last, first end to second.
std::vector<CarvingStep> file_order(const Scratches& scratches);

/// Length of the way in the air, mm, by the same rules.
double travel_mm(const Scratches& scratches, const std::vector<CarvingStep>& order,
                 const CarvingOrderOptions& options = {});

/// The scratches with their ends as an order has them: what scratches.csv should hold after carving by it, since its
/// rows are in carving order (docs/file-formats.md) and the tool wears along it.
Scratches in_carving_order(const Scratches& scratches, const std::vector<CarvingStep>& order);

}  // namespace burin
