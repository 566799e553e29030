// burin/optimize/design/cut_search.h - the re-insertion search for grooves that cut each other's rims away
// (Crossings::deepest).
//
// Seen from one place, a groove glints along one line: there its wall has the slope of the half vector. Another groove
// takes this light if its surface is lower, on a stretch of the line at each crossing (docs/model.md 6.11). The
// remaining pieces of every groove therefore follow stroke by stroke, without rendering. Removed strokes give light
// back to their crossed strokes, and inserted ones take it from theirs. The comparison uses the error of all views.
//
// Candidates come from stroke_tries.h, with the mean loss at crossings. Frame: board, mm. The same seed gives the same
// bits for any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "burin/optimize/design/stroke_field.h"
#include "burin/optimize/design/stroke_types.h"
#include "burin/optimize/design/to_metal.h"
#include "burin/scene/scratches.h"

namespace burin {

/// Improves the first `movable` scratches in one sweep, or in part of one once `stop` returns true. Each scratch is
/// made for the field in `view`. The fields must show all scratches as they cut each other, with StrokeView::kept and
/// cost; the function updates them. Returns the changed scratches, ascending.
std::vector<std::size_t> improve_cut(std::vector<StrokeField>& fields, const StrokeRules& rules, const Metal& metal,
                                     Scratches& scratches, const std::vector<std::size_t>& view, std::size_t movable,
                                     std::uint64_t seed, const std::function<bool()>& stop);

}  // namespace burin
