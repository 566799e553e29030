// burin/calib/verdict/next_photo.h - the most helpful additional photo for parameters left undetermined by a session's
// photos.
//
// Candidates (burin/calib/verdict/candidate_photo.h) have the camera on a hemisphere, under each lamp and under the
// first lamp moved around the board. Each adds its information to the information of the existing photos. The
// parameter's verdict names the candidate with the smallest variance and its predicted sigma, if the sigma decreases by
// a third: a smaller gain is not worth the effort. A moved lamp is a new lamp of the setup, and more work. It is named
// only if no photo under the existing lamps is informative enough. The camera stays within the focus of the existing
// photos (FocusRange), if the whole board is visible from there.
// Frame: board, mm.
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

/// For lens, tags and bow: sets Verdict::next_photo of undetermined parameters in `judged`.
void advise_geometry(const BoardSolution& geometry, const Board& board, const Combinations& judged, Bench& bench);

/// True if a photo is informative enough; no lamp then needs to move for a better one. `sigma_ratio`, the remaining
/// fraction of the parameter's sigma, is then at most two thirds. For a depth with an unseen cut-off, two such photos
/// must show it: `half_vectors` and `half_vectors_now` count half vectors on each side, with the photo and without
/// (otherwise 0).
bool is_worth_taking(double sigma_ratio, std::size_t half_vectors, std::size_t half_vectors_now);

/// Instructions for a photo under a lamp at a new place, different from all of the setup's `lamps` (not empty). They
/// contain the place, the entry of bench.json, and the folder of the photo (burin/capture/lamp_folders.h).
std::string moved_lamp_in_words(const Light& moved, const std::vector<Light>& lamps, const Board& board);

/// For grooves, lamps, machine and the rest of the light. Renders the candidates (some seconds), unless everything is
/// determined.
void advise_light(const Problem& data, const State& state, const Uncertainty& uncertainty, const Combinations& judged,
                  Bench& bench, const Progress& progress = {});

}  // namespace burin
