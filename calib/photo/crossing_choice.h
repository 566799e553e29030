// burin/calib/photo/crossing_choice.h - what is seen where grooves cross, by the rule that explains photos best.
// docs/model.md 7.6, 7.10.
//
// Grooves that are cut by one another are many pieces: of 10,000 strokes 15 mm long on 80 mm a groove crosses 230
// others. A few photos tell the rules apart as all do, and of a crowded board a sample of it.
#pragma once

#include <cstddef>

#include "burin/base/progress.h"
#include "burin/calib/photo/photo_problem.h"

namespace burin {

/// What is cut where it crosses: above this many pieces (expected_pieces) a photo's derivatives take more than 4 GB.
inline constexpr double kMostPieces = 6e6;

struct CrossingChoice {
  Crossings rule = Crossings::add;
  State state;
};
/// Fits from `state` by each rule, at the photos' resolution and weights. On a crowded board grooves alone are
/// fitted, to a part of it.
CrossingChoice choose_crossings(const Problem& data, const Stage& stage, const State& state, const Progress& progress);

}  // namespace burin
