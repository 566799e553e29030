// burin/calib/photo/crossing_choice.h - chooses the crossing rule by the photos. docs/model.md 7.6, 7.10.
//
// Grooves that cut one another become many pieces: of 10,000 strokes 15 mm long on 80 mm, a groove crosses 230 others.
// A few photos separate the rules as well as all do, and so does a sample of a crowded board.
#pragma once

#include <cstddef>

#include "burin/base/progress.h"
#include "burin/calib/photo/photo_problem.h"

namespace burin {

/// Limit of pieces (expected_pieces) for cut crossings: beyond it a photo's derivatives take more than 4 GB.
inline constexpr double kMostPieces = 6e6;

struct CrossingChoice {
  Crossings rule = Crossings::add;
  State state;
};
/// Fits from `state` by each rule, at the photos' resolution and weights. On a crowded board it fits grooves alone, to
/// a part of it.
CrossingChoice choose_crossings(const Problem& data, const Stage& stage, const State& state, const Progress& progress);

}  // namespace burin
