// burin/calib/verdict/next_photo.h - for what a session's photos left open: the one photo more that would help most.
//
// Every candidate (burin/calib/verdict/candidate_photo.h: the camera on a hemisphere, under each lamp and under the
// first one moved round the board) adds its information to that of the photos taken; the one that makes the parameter's
// variance smallest is named in the parameter's verdict, with what its sigma would come to. It stands within the focus
// that the photos taken have (FocusRange), wherever the whole board is seen from there. Frame: board, mm.
#pragma once

#include "burin/calib/geometry/board_solver.h"
#include "burin/calib/photo/photo_problem.h"
#include "burin/calib/verdict/identifiability.h"
#include "burin/calib/verdict/photo_uncertainty.h"
#include "burin/render/bench.h"
#include "burin/render/board.h"
#include "burin/render/progress.h"

namespace burin {

/// For lens, tags and bow: fills in Verdict::next_photo of those of `judged` that are not determined.
void advise_geometry(const BoardSolution& geometry, const Board& board, const Combinations& judged, Bench& bench);

/// For grooves, lamps, machine and the rest of the light; renders the candidates (some seconds), unless all of it is
/// determined.
void advise_light(const Problem& data, const State& state, const Uncertainty& uncertainty, const Combinations& judged,
                  Bench& bench, const Progress& progress = {});

}  // namespace burin
