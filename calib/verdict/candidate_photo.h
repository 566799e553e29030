// burin/calib/verdict/candidate_photo.h - predicted information of future photos from possible viewpoints.
//
// The information of a photo is its Fisher information: J^T W J of the predicted photo's derivatives, as in a fit to
// the real one. The corners of the tags inform about lens, bow and tags (burin/calib/geometry/bundle.h). All pixels
// (burin/calib/photo/photo_equations.h) and the tags' paper inform about lamp, grooves and machine. The prediction
// needs only an approximate setup.
// Frame: board, mm.
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

/// Adds the predicted corners of a photo from each place, without error, as views of `bundle` (after its existing
/// ones). Tags smaller than 15 px and invisible ones are omitted. The tags of `board` are in the order of bundle.tags.
/// `lens_scatter`: expected variation of their lenses, if any.
void append_candidates(Bundle& bundle, const Board& board, const std::vector<CameraPlace>& places,
                       double corner_sigma_px, const std::optional<LensScatter>& lens_scatter = {});

/// Predicted brightness of a candidate's photo, in radiance (linear value over gain and exposure factor).
struct PredictedLight {
  double paper = 0;  ///< of the brightest white paper
  double metal = 0;  ///< 0.999 quantile of the metal's pixels
};

/// Predicted information of a photo about light, grooves and machine, for all unknowns in the order of global_index().
struct LightCandidate {
  Eigen::MatrixXd information;
  Straddle straddle;
  PredictedLight light;
};

/// `data.model` gives board, scratches and crossing rule; `data.is_spot` marks spotlights. The function ignores the
/// photos and paper of `data`. `bench` gives lens, bow and tags. `free` marks the variable unknowns.
LightCandidate light_candidate(const Problem& data, const State& state, const Bench& bench, const CameraPlace& place,
                               std::size_t light, const std::vector<bool>& free,
                               const LightCandidateOptions& options = {});

}  // namespace burin
