// burin/calib/verdict/next_photo.h - for what a session's photos left open: the one photo more that would help most.
//
// Every candidate (burin/calib/verdict/candidate_photo.h: the camera on a hemisphere, under each lamp and under the
// first one moved round the board) adds its information to that of the photos taken; the one that makes the parameter's
// variance smallest is named in the parameter's verdict, with what its sigma would come to, if that is a third less: a
// photo that brings less is not worth the way. A moved lamp is another lamp to the bench, and work: it is named only
// where no photo under the lamps as they stand tells enough. The camera
// stands within the focus that the photos taken have (FocusRange), wherever the whole board is seen from there. Frame:
// board, mm.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "burin/base/progress.h"
#include "burin/calib/geometry/board_solver.h"
#include "burin/calib/photo/photo_problem.h"
#include "burin/calib/verdict/identifiability.h"
#include "burin/calib/verdict/photo_uncertainty.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// For lens, tags and bow: fills in Verdict::next_photo of those of `judged` that are not determined.
void advise_geometry(const BoardSolution& geometry, const Board& board, const Combinations& judged, Bench& bench);

/// Whether a photo tells enough to be taken, and under the lamps as they stand, so that none has to be put elsewhere
/// for one that tells more: what it leaves of the parameter's sigma is two thirds at most or, of a depth whose cut-off
/// is not seen (else 0), how many half vectors then lie on either side of it, and how many do now.
bool is_worth_taking(double sigma_ratio, std::size_t half_vectors, std::size_t half_vectors_now);

/// What a photo needs that is taken under a lamp where none of `lamps` (the bench's; not empty) stands: where it is,
/// what to write into bench.json, and which folder the photo goes into (burin/capture/lamp_folders.h).
std::string moved_lamp_in_words(const Light& moved, const std::vector<Light>& lamps, const Board& board);

/// For grooves, lamps, machine and the rest of the light; renders the candidates (some seconds), unless all of it is
/// determined.
void advise_light(const Problem& data, const State& state, const Uncertainty& uncertainty, const Combinations& judged,
                  Bench& bench, const Progress& progress = {});

}  // namespace burin
