// burin/optimize/design/cut_search.h - the search's step where grooves cut each other's rims away (Crossings::deepest).
//
// Seen from one place a groove glints along a line: where its wall has the lean that the half vector asks for. There
// another groove takes its light where that one's surface is lower, which is a stretch of the line at each crossing
// (docs/model.md 6.11). So what is left of every groove is known stroke by stroke, without rendering: those that the
// search takes out give light back to those that they cut, those that it puts in take light from them, and what is
// compared is the error of all views.
//
// Candidates are those of stroke_tries.h, by what crossings leave on average. Frame: board, mm. Same seed, same bits,
// for any number of threads.
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

/// One sweep over the first `movable` scratches, or a part of it once `stop` says so; each is meant for the field
/// `view` has for it. The fields must show all scratches as they cut each other, with StrokeView::kept and cost, and
/// follow the changes. Returns the scratches that were changed, ascending.
std::vector<std::size_t> improve_cut(std::vector<StrokeField>& fields, const StrokeRules& rules, const Metal& metal,
                                     Scratches& scratches, const std::vector<std::size_t>& view, std::size_t movable,
                                     std::uint64_t seed, const std::function<bool()>& stop);

}  // namespace burin
