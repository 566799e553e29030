// burin/calib/light/photo_faults.h - what tags tell about the photos they are in, before and after the solve: photos
// out of focus or moved while they were exposed, tags that are not where they should be seen, a lamp that moved between
// photos. Frames: board (mm), camera, pixels (center of the top-left pixel is (0, 0)).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "burin/calib/geometry/board_solver.h"
#include "burin/calib/light/light_samples.h"
#include "burin/render/bench.h"
#include "burin/render/board.h"
#include "burin/render/finding.h"

namespace burin {

/// Takes the tags out of photos that are much less sharp than the others (into `rejected`, with the reason), as long as
/// `keep_views` views remain: their corners would do, but their pixels tell the wrong roughness and depth.
void leave_out_blurred(std::vector<ViewTags>& pictures, std::size_t keep_views);

/// What was seen and not used, a finding for each reason: by tag, or by view where a view has it for most of its tags.
/// Views and tags that the solution lacks altogether have findings of their own and are passed over.
std::vector<Finding> rejected_tags(std::span<const ViewTags> pictures, const Board& board, const BoardSolution& solved);

/// Tags of board.json that the solved poses put well inside photos that show nothing of them.
std::vector<Finding> unseen_tags(std::span<const ViewTags> pictures, const Board& board, const BoardSolution& solved);

/// Photos of one light whose paper is shaded differently from the others': the lamp stood elsewhere, or something threw
/// a shadow. White paper is equally bright from everywhere, so that the ratio of two photos' tags is one number, but
/// for vignetting and gloss; the largest set of photos that agree is taken for right.
struct LampGroup {
  std::string light;
  std::vector<std::size_t> light_views;  ///< indices into the light views
  double spread = 0;                     ///< of log(white / white of the agreeing photos) over the board, RMS
};
std::vector<LampGroup> photos_of_another_lamp(std::span<const LightSample> samples, const Bench& bench);

}  // namespace burin
