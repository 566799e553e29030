// burin/calib/light/photo_faults.h - what tags tell about the photos they are in, before and after the solve: photos
// out of focus or moved while they were exposed, tags that are not where they should be seen, a lamp that moved between
// photos. Frames: board (mm), camera, pixels (center of the top-left pixel is (0, 0)).
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

/// Lamps that ride on the camera, by the paper in their photos: one place before the camera explains its brightness in
/// all of them far better than one beside the board. Their names.
std::vector<std::string> lamps_that_ride(std::span<const LightView> views, std::span<const LightSample> samples,
                                         const Bench& bench);

/// Whether a camera brightens what lies in the dark: local tone mapping, which phones do to their JPEGs as "HDR" or
/// "smart tones". No curve undoes it: what a pixel is stored as depends on what surrounds it. White paper is equally
/// bright from everywhere, so that the logarithm of a tag's brightness is a number of the tag, one of the photo, and
/// vignetting; whatever else goes with the brightness around the tag the camera made (or glare, which brightens).
///
/// Linear values go with the power of the brightness around them, as stored; below 0 where the dark is brightened.
struct LocalTones {
  double power = 0, sigma = 0;
};

/// Nothing where paper does not ask for it beyond chance. `samples`: of `views`, as gather_light_samples() made them.
std::optional<LocalTones> find_local_tones(std::span<const LightView> views, std::span<const LightSample> samples,
                                           const Bench& bench);

/// By what factor each pixel of a view would be brighter without, their mean taken as 1.
Image without_local_tones(const LightView& view, const LocalTones& tones);

/// The samples as they would be without.
std::vector<LightSample> without_local_tones(std::span<const LightView> views, std::span<const LightSample> samples,
                                             const LocalTones& tones, const Bench& bench);

/// What a person should know of it.
Finding told(const LocalTones& tones);

}  // namespace burin
