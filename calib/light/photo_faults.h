// burin/calib/light/photo_faults.h - detects faults of photos by their tags, before and after the solve. Faults are
// blur by focus or motion, tags away from their predicted place, and a lamp that moved between photos. Frames: board
// (mm), camera, pixels (center of the top-left pixel is (0, 0)).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "burin/base/finding.h"
#include "burin/base/image.h"
#include "burin/calib/geometry/board_solver.h"
#include "burin/calib/light/light_samples.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// Moves the tags of photos much less sharp than the others into `rejected`, with the reason, while `keep_views` views
/// remain. Their corners would do, but their pixels give wrong roughness and depth.
void leave_out_blurred(std::vector<ViewTags>& pictures, std::size_t keep_views);

/// A finding per reason for tags seen and not used: by tag, or by view if most of its tags share the reason. Views and
/// tags absent from the solution have findings of their own and are skipped.
std::vector<Finding> rejected_tags(std::span<const ViewTags> pictures, const Board& board, const BoardSolution& solved);

/// Tags of board.json predicted well inside photos by the solved poses, but not visible there.
std::vector<Finding> unseen_tags(std::span<const ViewTags> pictures, const Board& board, const BoardSolution& solved);

/// Photos of one light whose paper is shaded differently from the others': the lamp was elsewhere, or something cast a
/// shadow. White paper is equally bright from everywhere. The ratio of two photos' tags is therefore one number, except
/// for vignetting and gloss. The largest set of agreeing photos counts as correct.
struct LampGroup {
  std::string light;
  std::vector<std::size_t> light_views;  ///< indices into the light views
  double spread = 0;                     ///< of log(white / white of the agreeing photos) over the board, RMS
};
std::vector<LampGroup> photos_of_another_lamp(std::span<const LightSample> samples, const Bench& bench);

/// Names of lamps that move with the camera, by the paper in their photos. A place fixed to the camera explains the
/// brightness in all photos far better than one fixed to the board.
std::vector<std::string> lamps_that_ride(std::span<const LightView> views, std::span<const LightSample> samples,
                                         const Bench& bench);

/// Local tone mapping: a camera brightens dark surroundings, as phones do to their JPEGs ("HDR" or "smart tones"). No
/// curve undoes it, since the stored value of a pixel depends on its surroundings. White paper is equally bright from
/// everywhere. The logarithm of a tag's brightness is therefore one number of the tag, one of the photo, and
/// vignetting. Any further dependence on the brightness around the tag comes from the camera (or from glare, which
/// brightens).
///
/// Linear values vary with the power of the brightness around them, as stored; below 0 if dark areas are brightened.
struct LocalTones {
  double power = 0, sigma = 0;
};

/// Empty unless paper shows it beyond chance. `samples` are of `views`, from gather_light_samples().
std::optional<LocalTones> find_local_tones(std::span<const LightView> views, std::span<const LightSample> samples,
                                           const Bench& bench);

/// Factor of each pixel's brightness without local tones over its value, with mean 1.
Image without_local_tones(const LightView& view, const LocalTones& tones);

/// The samples without local tones.
std::vector<LightSample> without_local_tones(std::span<const LightView> views, std::span<const LightSample> samples,
                                             const LocalTones& tones, const Bench& bench);

/// A finding for the user.
Finding told(const LocalTones& tones);

}  // namespace burin
