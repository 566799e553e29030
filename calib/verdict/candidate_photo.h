// burin/calib/verdict/candidate_photo.h - photos that nobody took yet: where the camera could stand, and what a photo
// from there would tell.
//
// What a photo tells is its Fisher information, J^T W J of the predicted photo's derivatives, the same that a fit to
// the real one would have: of lens, bow and tags by its tags' corners (burin/calib/geometry/bundle.h), of lamp, grooves
// and machine by every pixel (burin/calib/photo/photo_equations.h) and the tags' paper. It needs no pixel to be taken,
// only a bench that is about right. Frame: board, mm.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "burin/calib/photo/photo_problem.h"
#include "burin/calib/verdict/camera_place.h"
#include "burin/calib/verdict/identifiability.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"
#include "burin/scene/lens.h"

namespace burin {

/// Adds the corners that a photo from each place would hold, without error, as views of `bundle` (after those it has).
/// Tags that the place sees smaller than 15 px or not at all are left out. Of the tags listed in `board`, bundle.tags
/// in the same order. `lens_scatter`: by how much their lenses will differ, if they will.
void append_candidates(Bundle& bundle, const Board& board, const std::vector<CameraPlace>& places,
                       double corner_sigma_px, const std::optional<LensScatter>& lens_scatter = {});

/// How bright a candidate's photo would be, in radiance (linear value over gain and exposure factor).
struct PredictedLight {
  double paper = 0;  ///< the brightest white paper
  double metal = 0;  ///< what one in a thousand pixels of metal exceeds
};

/// What a photo from a place would tell of light, grooves and machine, by all unknowns in the order of global_index().
struct LightCandidate {
  Eigen::MatrixXd information;
  Straddle straddle;
  PredictedLight light;
};

/// `data.model` says board, scratches and overlap, `data.is_spot` which lamps are spots; its photos and paper are not
/// looked at. `bench` gives lens, bow and tags. `free`: which unknowns move.
LightCandidate light_candidate(const Problem& data, const State& state, const Bench& bench, const CameraPlace& place,
                               std::size_t light, const std::vector<bool>& free,
                               const LightCandidateOptions& options = {});

}  // namespace burin
