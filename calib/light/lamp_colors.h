// burin/calib/light/lamp_colors.h - the colors of lamps from the tags' white paper, which is the same under all of
// them: their white balance. docs/model.md 9, 'Lamp'. Ambient light is taken for gray here; refine tells its color as
// well, from all pixels.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "burin/capture/photo.h"
#include "burin/capture/session.h"
#include "burin/capture/tags/tag_detector.h"
#include "burin/scene/bench.h"
#include "burin/scene/board.h"

namespace burin {

/// Which of a tag's pixels are white paper away from edges, two fifths of a tag being white: the brightest fifth by
/// green, or, for lamps without green, the fifth in the middle of those two by the mean of the channels, which noise
/// does not make brighter.
enum class WhiteBy { green, mean };

/// R, G, B summed over those pixels. Nothing for a view in gray, or a tag of too few pixels. `view` may be binned.
std::optional<Eigen::Vector3d> white_paper(const MergedView& view, const TagDetection& tag, WhiteBy by);

/// The light of each tag's white paper in one merged view, R, G, B over their mean.
std::vector<Eigen::Vector3d> paper_light(const MergedView& view, const TagsInPhoto& tags);

/// Gives each lamp, whose intensity is the same in all channels, its color: the median over the papers that were seen
/// under it (an entry a bracket), without the share of ambient light on paper in the board's middle, none below 0, the
/// mean of its channels being kept. Lamps without a view in color stay.
void color_lamps(std::span<const Bracket> brackets, std::span<const std::vector<Eigen::Vector3d>> paper,
                 const Board& board, Bench& bench);

}  // namespace burin
